#include "tod/measurement/set_up_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "tod/measurement/geometry.h"

namespace todbench {
namespace {

/// Below this correlation successive frames understate the noise of one by less than 3 %.
constexpr double noticeable_correlation = 0.05;
/// Least contrast of the large triangles of a frame, in its standard uncertainty.
constexpr double least_certainty = 3;
/// Noise below this part of a step leaves differences of up to half a step that no averaging shows.
constexpr double dithering_noise_steps = 0.5;

/// Noise of a pixel in one frame. Noise that remembers shows only sqrt(1 - rho) of itself in successive frames.
double noise_of_one_frame(const AveragedPicture& picture) {
  const double rho = picture.lag1_correlation.value_or(0);
  // Beyond 0.99 it changes so slowly that so few frames do not tell it from drift.
  if (rho < noticeable_correlation) return picture.temporal_noise_k;
  return picture.temporal_noise_k / std::sqrt(1 - std::min(rho, 0.99));
}

const RadiometricScale& scale_of_counts() {
  static const RadiometricScale scale = RadiometricScale::linear({.kelvin_per_count = 1, .offset_k = 0}).value();
  return scale;
}

std::string plate_and_mounting(const TargetState& state) {
  return "plate " + state.plate + ", mounting " + std::string(to_string(state.mounting));
}

}  // namespace

FrameTakerOptions taker_options(const MeasurementOptions& options, const SourceInfo& camera,
                                std::function<void(const RejectedFrame&)> on_rejected) {
  FrameTakerOptions out{.integrity = options.integrity,
                        .frames_after_change = options.frames_after_change,
                        .nuc_wait_s = options.nuc_wait_s,
                        .max_rejected_share = options.max_rejected_share,
                        .frame_timeout = options.frame_timeout,
                        .on_rejected = std::move(on_rejected)};
  out.integrity.width = camera.width;
  out.integrity.height = camera.height;
  if (options.contrast_unit == ContrastUnit::grey_levels)
    out.scale = std::make_shared<const RadiometricScale>(scale_of_counts());
  return out;
}

Result<void> check_grey_references(const MeasurementOptions& options) {
  if (options.contrast_unit != ContrastUnit::grey_levels) return {};
  if (!(options.distance_m > 0) || !(options.ifov_mrad > 0))
    return fail(ErrorCode::invalid_input, "distance and IFOV must be positive");
  for (const TargetPlate& plate : options.plates) {
    int enough = 0;
    double largest = 0;
    for (const PlateTriangle& triangle : plate.triangles) {
      const double size_px = triangle.size_mm / (options.distance_m * options.ifov_mrad);
      largest = std::max(largest, size_px);
      enough += size_px >= options.min_reference_px ? 1 : 0;
    }
    if (enough >= 2) continue;
    return fail(
        ErrorCode::invalid_input,
        fmt::format("plate {} has {} of at least {:.1f} pixels (the largest is {:.1f}): a contrast in grey "
                    "levels needs two and more in every frame",
                    plate.name, enough == 0 ? "no triangle" : "one triangle", options.min_reference_px, largest));
  }
  return {};
}

Result<void> check_before_measuring(const MeasurementOptions& options, Observer& observer, const SourceInfo& camera) {
  if (options.contrast_unit == ContrastUnit::kelvin && !camera.scale.calibrated()) {
    return fail(ErrorCode::calibration,
                "camera " + camera.id + " has no temperature scale: contrasts in kelvin cannot be measured");
  }
  if (auto references = check_grey_references(options); !references) return references;
  const auto misfits = find_misfits(options, observer, {camera.width, camera.height});
  if (!misfits) return tl::unexpected(misfits.error());
  if (!misfits->empty())
    return fail(ErrorCode::invalid_input, "not measurable at this distance: " + sentences(*misfits, misfits->size()));
  return {};
}

Result<AveragedPicture> SetUpStep::look(std::stop_token stop) {
  auto picture = taker_.average(options_.registration_frames, std::move(stop));
  // Grey levels are no kelvin before their contrast is known.
  if (picture && !grey() && temporal_noise_k_ == 0) keep_noise(*picture);
  return picture;
}

void SetUpStep::keep_noise(const AveragedPicture& picture) {
  temporal_noise_k_ = picture.temporal_noise_k;
  noise_of_frame_k_ = noise_of_one_frame(picture);
  lag1_correlation_ = picture.lag1_correlation;
  const auto surround = camera_.info().scale.counts(cv::mean(picture.kelvin)[0]);
  const auto per_count = surround ? camera_.info().scale.kelvin_per_count(*surround) : std::nullopt;
  if (per_count && picture.temporal_noise_k > 0)
    noise_counts_ = picture.temporal_noise_k / *per_count / std::max(1, picture.count_step);
}

Result<Registration> SetUpStep::find(const AveragedPicture& picture, const TargetPlate& mounted_plate,
                                     const TargetState& state) const {
  const std::string where = "plate " + state.plate + " mounted " + std::string(to_string(state.mounting));
  auto registration = register_plate(picture.kelvin, mounted_plate, options_.registration);
  if (!registration) return fail("registering " + where, registration.error());
  if ((registration->contrast_sign > 0) != (state.delta_t_k > 0)) {
    return fail(ErrorCode::calibration,
                "the triangles of " + where + " have the opposite polarity of the contrast asked for");
  }
  return registration;
}

std::optional<std::string> SetUpStep::read_back_deviation(const TargetState& set, const PresentedTarget& said) const {
  const double deviation_k = said.state.delta_t_k - set.delta_t_k;
  if (options_.max_readback_deviation_k <= 0 || std::abs(deviation_k) <= options_.max_readback_deviation_k)
    return std::nullopt;
  return fmt::format("{}: the target says it shows {:.4f} K where {:.4f} K were set ({:+.4f} K, tolerance {:.4f} K)",
                     plate_and_mounting(set), said.state.delta_t_k, set.delta_t_k, deviation_k,
                     options_.max_readback_deviation_k);
}

double SetUpStep::response(const std::string& plate) const {
  const auto known = options_.contrast_response.find(plate);
  return known == options_.contrast_response.end() ? 1.0 : known->second;
}

void SetUpStep::note_saturation(const AveragedPicture& picture, const TargetPlate& mounted_plate,
                                const Registration& registration, const TargetState& set, double contrast) {
  const RadiometricScale& scale = grey() ? scale_of_counts() : camera_.info().scale;
  const int cut_off = saturation_.learn(picture, scale, mounted_plate, registration, contrast);
  if (cut_off == 0) return;
  note_(
      fmt::format("{}: {} pixels of the triangles are at an end of the camera's counts: the contrast of {:+.3f} K "
                  "that was set is cut off there",
                  plate_and_mounting(set), cut_off, set.delta_t_k));
}

Result<SeenContrast> SetUpStep::contrast(const TargetPlate& mounted_plate, const Registration& registration,
                                         const TargetState& set, const PresentedTarget& said, std::stop_token stop) {
  const auto picture = taker_.average(options_.contrast_frames, std::move(stop));
  if (!picture) return tl::unexpected(picture.error());
  const auto measured = effective_contrast(picture->kelvin, mounted_plate, registration, options_.min_reference_px,
                                           level_estimate(options_.contrast_unit));
  if (!measured) return fail("measuring the effective contrast", measured.error());
  note_saturation(*picture, mounted_plate, registration, set, measured->value);
  if (!(measured->value * set.delta_t_k > 0)) {
    return fail(ErrorCode::calibration,
                fmt::format("the target was set to {:+.3f} K but the camera sees {:+.3f} {} +- {:.3f}", set.delta_t_k,
                            measured->value, grey() ? "grey levels" : "K", measured->standard_error));
  }
  return grey() ? in_grey_levels(*picture, *measured, set, said) : in_kelvin(*measured, set);
}

SeenContrast SetUpStep::in_kelvin(const EffectiveContrast& measured, const TargetState& set) const {
  const double seen_k = measured.value / response(set.plate);
  const double deviation = seen_k / set.delta_t_k - 1;
  if (std::abs(deviation) > 0.2 && std::abs(seen_k - set.delta_t_k) > 3 * measured.standard_error) {
    note_(fmt::format("{}: the camera sees {:.3f} K where {:.3f} K were set ({:+.0f} %)", plate_and_mounting(set),
                      seen_k, set.delta_t_k, 100 * deviation));
  }
  SeenContrast seen{.contrast_k = seen_k, .noise_k = noise_of_frame_k_};
  seen.references = measured.references;
  for (ReferenceTriangle& reference : seen.references) reference.value /= response(set.plate);
  if (measured.triangles > 1) seen.standard_error_k = measured.standard_error / response(set.plate);
  return seen;
}

SeenContrast SetUpStep::in_grey_levels(const AveragedPicture& picture, const EffectiveContrast& measured,
                                       const TargetState& set, const PresentedTarget& said) {
  const double said_k = said.state.delta_t_k;
  const bool believed = std::isfinite(said_k) && said_k * set.delta_t_k > 0;
  SeenContrast seen{.contrast_k = (believed ? said_k : set.delta_t_k) * options_.air_transmittance.value_or(1)};
  seen.levels_per_k = measured.value / response(set.plate) / seen.contrast_k;
  seen.noise_k = noise_of_one_frame(picture) / seen.levels_per_k;
  seen.steps = grey_steps(picture.lowest, picture.highest, picture.temporal_noise_k);
  if (temporal_noise_k_ == 0 && picture.temporal_noise_k > 0) {
    temporal_noise_k_ = picture.temporal_noise_k / seen.levels_per_k;
    lag1_correlation_ = picture.lag1_correlation;
  }
  const double noise_steps = seen.steps.noise_levels / seen.steps.step_levels;
  // The coarsest of all contrasts speaks for the run.
  noise_counts_ = std::min(noise_counts_.value_or(noise_steps), noise_steps);
  if (seen.steps.noise_steps() < dithering_noise_steps) {
    note_(
        fmt::format("{}, {:+.3f} K: the noise of a pixel is {:.2f} steps of {:.2g} grey levels: what differs by less "
                    "than a step may look alike",
                    plate_and_mounting(set), set.delta_t_k, seen.steps.noise_steps(), seen.steps.step_levels));
  }
  return seen;
}

Result<GreyFrame> SetUpStep::grey_frame(const Frame& frame, const TargetPlate& mounted_plate,
                                        const Registration& registration, const TargetState& set,
                                        const SeenContrast& seen) const {
  cv::Mat1d levels;
  frame.counts.convertTo(levels, CV_64F);
  const auto contrast = grey_contrast(levels, mounted_plate, registration, options_.min_reference_px, seen.steps);
  if (!contrast) return fail("measuring the contrast in grey levels", contrast.error());
  // Of the sign of the contrast, too: a gain does not turn round.
  if (!(contrast->levels * seen.contrast_k > 0 &&
        std::abs(contrast->levels) >= least_certainty * contrast->standard_uncertainty)) {
    return fail(ErrorCode::calibration,
                fmt::format("{}: the large triangles of frame {} differ by {:+.2f} +- {:.2f} grey levels at {:+.3f} K: "
                            "too little to measure by",
                            plate_and_mounting(set), frame.sequence, contrast->levels, contrast->standard_uncertainty,
                            set.delta_t_k));
  }
  return GreyFrame{.plate = set.plate,
                   .mounting = set.mounting,
                   .set_delta_t_k = set.delta_t_k,
                   .delta_t_k = seen.contrast_k,
                   .frame = frame.sequence,
                   .contrast = *contrast,
                   .levels_per_k = contrast->levels / response(set.plate) / seen.contrast_k,
                   .noise_steps = seen.steps.noise_steps()};
}

}  // namespace todbench
