// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/twin/camera_surrogate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "acquisition/base/distributions.h"
#include "bench/plan/plan_options.h"
#include "bench/twin/simulated_responses.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/presentation/largest_contrast.h"
#include "tod/psychometric/contrast_slope.h"

namespace todbench {
namespace {

constexpr double false_alarm = 0.002;        ///< stays below 1 % with errors of registration
constexpr double least_certainty = 20;       ///< of a contrast, over the noise of an averaged pixel
constexpr double t_limit = 2.58;             ///< 1 % of a normal distribution, two-sided
constexpr double least_netd_change = 0.1;    ///< of the variance
constexpr double least_line_change = 0.03;   ///< of the variance of a pixel
constexpr double learnt_anew_pitch = 0.005;  ///< above it, a response is simulated again
constexpr double learnt_anew_ratio = 0.02;

int samples_of(const LoadedPlan& loaded) {
  const double camera_mrad = loaded.plan().camera.ifov_mrad;
  if (!(camera_mrad > 0)) return loaded.sensor().samples_per_pitch();
  return std::clamp(static_cast<int>(std::lround(loaded.sensor().ifov_mrad() / camera_mrad)), 1, 4);
}

/// A simulated scene has the wavelengths of the plan's accuracy, a real one a dense set.
int wavelengths_of(const LoadedPlan& loaded, const ExperimentInputs& inputs) {
  return loaded.plan().target.kind == TargetKind::scene ? inputs.accuracy.wavelengths : 16;
}

}  // namespace

CameraSurrogate::CameraSurrogate(const LoadedPlan& loaded, const ExperimentInputs& inputs,
                                 std::map<std::string, double> responses)
    : loaded_(loaded),
      inputs_(inputs),
      twin_responses_(responses),
      responses_(std::move(responses)),
      fit_(loaded.sensor(), samples_of(loaded), wavelengths_of(loaded, inputs)),
      halo_fit_(loaded.sensor(), samples_of(loaded)),
      samples_per_pitch_(samples_of(loaded)) {
  const Plan& plan = loaded.plan();
  largest_k_ = std::abs(largest_contrast_k(plan.target.delta_t_k));
  // A module of the plan stands behind the camera; these pictures come from the camera itself.
  possible_ = plan.camera.contrast == ContrastUnit::kelvin && inputs.sensor.modules.empty() &&
              CameraOpticsFit::models(loaded.sensor());
}

void CameraSurrogate::add_noise(const SetUpPicture& found) {
  const AveragedPicture& picture = found.picture;
  if (!picture.row_variance_k2 || !picture.column_variance_k2) return;
  ++pictures_;
  total_ += picture.temporal_noise_k * picture.temporal_noise_k;
  rows_ += *picture.row_variance_k2;
  columns_ += *picture.column_variance_k2;
  correlation_ += picture.lag1_correlation.value_or(0);
  pairs_ += found.frames - 1;
  size_ = picture.kelvin.size();
}

std::map<std::string, double> CameraSurrogate::learn(const SetUpPicture& found) {
  if (!possible_) return {};
  add_noise(found);
  const bool largest = std::abs(found.state.delta_t_k) >= 0.999 * largest_k_;
  const double noise_k = found.picture.temporal_noise_k / std::sqrt(found.frames);
  // Until the largest contrast comes, a lower one has to suffice.
  const bool enough = largest || (!fit_.result() && std::abs(found.state.delta_t_k) > least_certainty * noise_k);
  if (enough) add_to_fit(found);
  return learnt_response(found);
}

void CameraSurrogate::add_to_fit(const SetUpPicture& found) {
  const double rho = std::clamp(found.picture.lag1_correlation.value_or(0), 0.0, 0.95);
  // For first-order noise, successive frames show 1 - rho of its variance, and the variance of the mean is (1 + rho) /
  // (1 - rho) times that of independent frames.
  const double averaged = found.picture.temporal_noise_k * std::sqrt((1 + rho) / found.frames) / (1 - rho);
  const OpticsPicture picture{.picture = found.picture.kelvin,
                              .mounted_plate = found.mounted_plate,
                              .registration = found.registration,
                              .min_size_px = camera_options(loaded_.plan(), inputs_.plates).min_reference_px,
                              .averaged_noise_k = averaged};
  if (!fit_.add(picture)) return;
  halo_fit_.add(picture, found.state.delta_t_k);
  const double looks = static_cast<double>(set_ups_of(loaded_.plan().target));
  optics_differ_ = optics_differ_ || fit_.result()->differs(false_alarm / std::max(1.0, looks));
}

std::map<std::string, double> CameraSurrogate::learnt_response(const SetUpPicture& found) {
  const auto optics = fit_.result();
  if (!optics) return {};
  if (!optics_differ_ && samples_per_pitch_ == loaded_.sensor().samples_per_pitch()) return {};
  const auto plate = std::ranges::find(inputs_.plates, found.state.plate, &TargetPlate::name);
  if (plate == inputs_.plates.end()) return {};
  const auto before = learnt_.find(plate->name);
  if (before != learnt_.end() && std::abs(before->second.sigma - optics->aberration_sigma_pitch) < learnt_anew_pitch &&
      std::abs(before->second.ratio - optics->f_number_ratio) < learnt_anew_ratio)
    return {};
  const SensorSpec spec = sensor(false);
  const SensorModel model(spec, full_plan(spec, {}, {}), inputs_.accuracy, loaded_.plan().seed);
  const auto response =
      simulated_responses(model, loaded_.plan(), {*plate}, camera_options(loaded_.plan(), inputs_.plates), {});
  if (!response) return {};
  learnt_[plate->name] = {optics->aberration_sigma_pitch, optics->f_number_ratio};
  responses_[plate->name] = response->at(plate->name);
  return *response;
}

std::optional<CameraSurrogate::Noise> CameraSurrogate::noise() const {
  if (pictures_ == 0 || !(pairs_ > 0)) return std::nullopt;
  const double n = pictures_;
  Noise out{.row = rows_ / n, .column = columns_ / n, .correlation = correlation_ / n};
  const double seen = total_ / n - out.row - out.column;
  // Successive differences have a frame in common.
  const auto relative = [&](double values) { return std::sqrt(3 / (values * pairs_)); };
  const double rho = out.correlation > 0.05 ? std::min(out.correlation, 0.95) : 0;
  out.pixel = seen / (1 - rho);
  out.pixel_se = out.pixel * relative(static_cast<double>(size_.area()));
  out.row_se = (std::max(0.0, out.row) + seen / size_.width) * relative(size_.height);
  out.column_se = (std::max(0.0, out.column) + seen / size_.height) * relative(size_.width);
  return out;
}

bool CameraSurrogate::noise_differs() const {
  const auto found = noise();
  const SensorSpec& twin = loaded_.sensor();
  const double exposures = twin.exposures_per_sample();
  const double pixel = twin.netd_k * twin.netd_k / exposures,
               count = twin.kelvin_per_count * twin.kelvin_per_count / 12;
  // These numbers do not cover noise hidden by rounding or noise of single detectors.
  if (!found || !(pixel > 4 * count) || twin.defective_pixel_share > 0) return false;
  const auto other = [&](double camera, double stated, double se, double least) {
    return std::abs(camera - stated) > std::max(t_limit * se, least);
  };
  const auto optics = fit_.result();
  const double line = least_line_change * pixel;
  return other(found->pixel - count, pixel, found->pixel_se, least_netd_change * pixel) ||
         other(found->row, std::pow(twin.row_noise_k, 2) / exposures, found->row_se, line) ||
         other(found->column, std::pow(twin.column_noise_k, 2) / exposures, found->column_se, line) ||
         (optics && other(std::pow(optics->fixed_pattern_k, 2), std::pow(twin.fixed_pattern_k, 2),
                          optics->fixed_pattern_variance_se_k2, line));
}

SensorSpec CameraSurrogate::sensor(bool with_noise) const {
  SensorSpec spec = loaded_.sensor();
  const auto optics = fit_.result();
  if (optics && optics_differ_) {
    spec.aberration_sigma_pitch = optics->aberration_sigma_pitch;
    spec.f_number *= optics->f_number_ratio;
  }
  if (samples_per_pitch_ != spec.samples_per_pitch()) spec.microscan = samples_per_pitch_;
  const auto found = noise();
  if (!with_noise || !found || !noise_differs()) return spec;
  const double exposures = spec.exposures_per_sample();
  const double count = spec.kelvin_per_count * spec.kelvin_per_count / 12;
  const auto of_frame = [&](double variance) { return std::sqrt(std::max(0.0, variance) * exposures); };
  spec.netd_k = of_frame(found->pixel - count);
  spec.row_noise_k = found->row > t_limit * found->row_se ? of_frame(found->row) : 0;
  spec.column_noise_k = found->column > t_limit * found->column_se ? of_frame(found->column) : 0;
  const double pattern = optics ? std::pow(optics->fixed_pattern_k, 2) : 0;
  if (optics) spec.fixed_pattern_k = pattern > t_limit * optics->fixed_pattern_variance_se_k2 ? std::sqrt(pattern) : 0;
  if (exposures == 1) spec.noise_correlation = found->correlation > 0.05 ? std::min(found->correlation, 0.95) : 0;
  return spec;
}

bool CameraSurrogate::differs() const {
  return possible_ && fit_.result() &&
         (optics_differ_ || samples_per_pitch_ != loaded_.sensor().samples_per_pitch() || noise_differs());
}

std::optional<ExperimentInputs> CameraSurrogate::lent() const {
  if (!differs()) return std::nullopt;
  ExperimentInputs out = inputs_;
  const SensorSpec spec = sensor(true);
  if (!validate(spec)) return std::nullopt;
  out.effects = full_plan(spec, loaded_.plan().simulation.skip, loaded_.plan().simulation.force, inputs_.motion);
  out.sensor = as_planned(spec, out.effects);
  return out;
}

bool CameraSurrogate::refused() const {
  const auto optics = fit_.result();
  return possible_ && optics && (!optics->fits() || (differs() && !validate(sensor(true))));
}

std::optional<CameraHalo> CameraSurrogate::halo() const {
  const auto optics = fit_.result();
  return possible_ && optics ? halo_fit_.result(optics->f_number_ratio) : std::nullopt;
}

double CameraSurrogate::response_shift() const {
  const auto halo = this->halo();
  double largest = halo ? std::abs(halo->share) : 0;
  for (const auto& [plate, response] : responses_) {
    const auto twin = twin_responses_.find(plate);
    if (twin != twin_responses_.end()) largest = std::max(largest, std::abs(std::log(response / twin->second)));
  }
  return largest;
}

std::optional<CameraOpticsRecord> CameraSurrogate::record() const {
  const auto optics = fit_.result();
  if (!possible_ || !optics) return std::nullopt;
  CameraOpticsRecord out{.aberration_sigma_pitch = optics->aberration_sigma_pitch,
                         .aberration_se_pitch = optics->aberration_se_pitch,
                         .f_number_ratio = optics->f_number_ratio,
                         .f_number_ratio_se = optics->f_number_ratio_se,
                         .samples_per_pitch = samples_per_pitch_,
                         .chi2 = optics->chi2,
                         .chi2_limit = optics->chi2_limit,
                         .degrees_of_freedom = optics->degrees_of_freedom,
                         .fixed_pattern_k = optics->fixed_pattern_k,
                         .refused = refused(),
                         .surrogate_taken = lent().has_value(),
                         .contrast_response = responses_};
  if (const auto halo = this->halo()) {
    out.halo_share = halo->share;
    out.halo_share_se = halo->share_se;
    out.halo_sigma_px = halo->sigma_px;
  }
  if (const auto found = noise()) {
    out.netd_k = std::sqrt(std::max(0.0, found->pixel));
    out.row_noise_k = std::sqrt(std::max(0.0, found->row));
    out.column_noise_k = std::sqrt(std::max(0.0, found->column));
    out.noise_correlation = found->correlation;
  }
  return out;
}

std::optional<std::string> CameraSurrogate::sentence() const {
  const auto found = record();
  if (!found || (!found->surrogate_taken && !found->refused)) return std::nullopt;
  std::string text = fmt::format(
      "the camera's own pictures show an aberration of {:.3f} +- {:.3f} pitches, {:.3f} +- {:.3f} times the f-number "
      "of {}, and pixel noise of {:.3f} K (chi-square {:.2f}, limit {:.2f})",
      found->aberration_sigma_pitch, found->aberration_se_pitch, found->f_number_ratio, found->f_number_ratio_se,
      loaded_.sensor().name, found->netd_k, found->chi2, found->chi2_limit);
  if (found->surrogate_taken)
    text += ". The contrast and the function for the camera's fit are computed for a sensor with these values";
  return text;
}

AdequacyFinding CameraSurrogate::finding() const {
  const auto optics = fit_.result();
  if (unseen()) {
    return {.kind = FindingKind::surrogate,
            .sentence =
                "the frames do not show whether the camera has the optics and the noise of its twin. The fit uses the "
                "twin's function, so the interval is wider by the effect of another slope",
            .unfit = false};
  }
  if (const auto halo = this->halo(); halo && !refused()) {
    return {.kind = FindingKind::surrogate,
            .value = halo->share,
            .sentence = fmt::format(
                "the plate between the triangles shows {:.1f} +- {:.1f} % of their light (halo of {:g} px) that the "
                "twin does not spread, or a plate that is warm beside its openings. The contrast of small triangles is "
                "lower by up to this share, so the interval is wider. Measure the size-of-source effect",
                100 * halo->share, 196 * halo->share_se, halo->sigma_px),
            .unfit = false};
  }
  if (optics && optics->fits()) {
    return {.kind = FindingKind::surrogate,
            .sentence =
                "the frames show noise or optics that no simulated sensor has. Contrast and function may not be "
                "those of this camera, so the interval is wider",
            .unfit = false};
  }
  return {.kind = FindingKind::surrogate,
          .value = optics ? std::optional(optics->chi2) : std::nullopt,
          .limit = optics ? std::optional(optics->chi2_limit) : std::nullopt,
          .sentence = fmt::format(
              "no blur and f-number explain the pictures of the large triangles (chi-square {:.2f}, limit {:.2f}). "
              "Contrast and function may not be those of this camera, so the interval is wider",
              optics ? optics->chi2 : 0, optics ? optics->chi2_limit : 0),
          .unfit = false};
}

}  // namespace todbench
