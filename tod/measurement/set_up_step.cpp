// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/set_up_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "acquisition/base/try.h"
#include "acquisition/core/judged_picture.h"
#include "tod/measurement/geometry.h"

namespace todbench {
namespace {

/// Least contrast of the large triangles of a frame, in its standard uncertainty.
constexpr double least_certainty = 3;
/// With noise below this part of a step, errors of up to half a step remain that no averaging reveals.
constexpr double dithering_noise_steps = 0.5;

const RadiometricScale& scale_of_counts() {
  static const RadiometricScale scale = RadiometricScale::linear({.kelvin_per_count = 1, .offset_k = 0}).value();
  return scale;
}

std::string plate_and_mounting(const TargetState& state) {
  return "plate " + state.plate + ", mounting " + std::string(to_string(state.mounting));
}

/// Returns the mean of pictures of one size; empty for none, and for different sizes.
cv::Mat1d mean_of(std::span<const cv::Mat1w> pictures) {
  if (pictures.empty()) return {};
  cv::Mat1d mean = cv::Mat1d::zeros(pictures.front().size());
  for (const cv::Mat1w& picture : pictures) {
    if (picture.size() != mean.size()) return {};
    cv::add(mean, picture, mean, cv::noArray(), CV_64F);
  }
  return mean / static_cast<double>(pictures.size());
}

}  // namespace

std::string unexpected_sign(double set_k, const EffectiveContrast& observed, ContrastUnit unit,
                            std::optional<double> kelvin_per_count) {
  std::string text =
      fmt::format("the target was set to {:+.3f} K, but the camera observes {:+.3f} {} +- {:.3f}: ", set_k,
                  observed.value, unit == ContrastUnit::grey_levels ? "grey levels" : "K", observed.standard_error);
  if (kelvin_per_count && std::abs(set_k) < std::abs(*kelvin_per_count))
    return text + fmt::format("the contrast is below one count of the camera ({:.3g} K)", std::abs(*kelvin_per_count));
  if (std::abs(observed.value) <= least_certainty * observed.standard_error)
    return text +
           "the contrast is not seen above the noise; average more frames ([measurement] contrast_frames) or "
           "choose a larger contrast";
  return text + "one of them has the wrong sign";
}

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
  if (options.contrast_unit == ContrastUnit::grey_levels) {
    out.scale = std::make_shared<const RadiometricScale>(scale_of_counts());
    out.gain = FrameGain::changing;
  }
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
    return fail(ErrorCode::invalid_input, fmt::format("plate {} has {} of at least {:.1f} pixels (the largest is "
                                                      "{:.1f}): a contrast in grey levels needs at least two",
                                                      plate.name, enough == 0 ? "no triangle" : "one triangle",
                                                      options.min_reference_px, largest));
  }
  return {};
}

Result<void> check_before_measuring(const MeasurementOptions& options, Observer& observer, const SourceInfo& camera) {
  if (options.contrast_unit == ContrastUnit::kelvin && !camera.scale.calibrated()) {
    return fail(ErrorCode::calibration,
                "camera " + camera.id + " has no temperature scale: contrasts in kelvin cannot be measured");
  }
  TODBENCH_TRY_VOID(check_grey_references(options));
  TODBENCH_TRY(const auto misfits, find_misfits(options, observer, {camera.width, camera.height}));
  if (!misfits.empty())
    return fail(ErrorCode::invalid_input, "not measurable at this distance: " + sentences(misfits, misfits.size()));
  return {};
}

Result<AveragedPicture> SetUpStep::average(int count, std::stop_token stop, const FrameTaker::EachFrame& each) {
  cv::Mat1d first, last;
  std::vector<cv::Mat1w> judged;
  auto picture = taker_.average(count, std::move(stop), [&](const Frame& frame, const cv::Mat1d& kelvin) {
    if (each) each(frame, kelvin);
    if (!grey() && behind_stages(frame)) judged.push_back(as_judged(frame).counts.clone());
    if (first.empty()) first = kelvin;
    last = kelvin;
  });
  if (!picture) return picture;
  const cv::Mat1d judged_mean = mean_of(judged);
  // Grey levels may have another gain in every frame; a contrast on its way differs between the frames.
  if (!grey() && wait_ == ContrastWait::settled && !before_.empty()) {
    keep_residue(picture_residue(before_, first, last, picture->kelvin, noise_of_one_frame(*picture)));
    keep_residue(judged_residue(judged_before_, judged, judged_mean));
  }
  before_ = picture->kelvin;
  judged_before_ = judged_mean;
  return picture;
}

void SetUpStep::keep_residue(const std::optional<PictureResidue>& residue) {
  auto& worst = constancy_.residue;
  if (residue && (!worst || residue->share * worst->limit > worst->share * residue->limit)) worst = residue;
}

Result<AveragedPicture> SetUpStep::look(std::stop_token stop) {
  JudgedMemory memory(options_.registration_frames);
  auto picture = average(options_.registration_frames, std::move(stop),
                         [&memory](const Frame& frame, const cv::Mat1d& /*kelvin*/) { memory.add(frame); });
  memory_ratio_ = memory.ratio();
  // Grey levels are not kelvin before their contrast is known.
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
  if (!registration && saturated(picture))
    return fail(
        ErrorCode::calibration,
        fmt::format("registering {}: the picture is saturated: at {:+.3f} K many of its pixels stay at an end of "
                    "the camera's counts, so the shapes of the triangles are wrong; choose a smaller contrast "
                    "or a larger range of the camera ({})",
                    where, state.delta_t_k, registration.error().message));
  if (!registration) return fail("registering " + where, registration.error());
  if ((registration->contrast_sign > 0) != (state.delta_t_k > 0)) {
    return fail(ErrorCode::calibration,
                "the triangles of " + where + " have the polarity opposite to the set contrast");
  }
  return registration;
}

std::optional<std::string> SetUpStep::read_back_deviation(const TargetState& set, const PresentedTarget& said) const {
  const double deviation_k = said.state.delta_t_k - set.delta_t_k;
  if (options_.max_readback_deviation_k <= 0 || std::abs(deviation_k) <= options_.max_readback_deviation_k)
    return std::nullopt;
  return fmt::format("{}: the target reports {:.4f} K, but {:.4f} K were set (deviation {:+.4f} K, tolerance {:.4f} K)",
                     plate_and_mounting(set), said.state.delta_t_k, set.delta_t_k, deviation_k,
                     options_.max_readback_deviation_k);
}

double SetUpStep::response(const std::string& plate) const {
  if (const auto learnt = learnt_response_.find(plate); learnt != learnt_response_.end()) return learnt->second;
  const auto known = options_.contrast_response.find(plate);
  return known == options_.contrast_response.end() ? 1.0 : known->second;
}

void SetUpStep::note_saturation(const AveragedPicture& picture, const TargetPlate& mounted_plate,
                                const Registration& registration, const TargetState& set, double contrast) {
  const RadiometricScale& scale = grey() ? scale_of_counts() : camera_.info().scale;
  const int cut_off = saturation_.learn(picture, scale, mounted_plate, registration, contrast);
  if (cut_off == 0) return;
  note_(fmt::format(
      "{}: {} pixels of the triangles are at an end of the camera's counts: they clip the set contrast of {:+.3f} K",
      plate_and_mounting(set), cut_off, set.delta_t_k));
}

void SetUpStep::note_saturation_behind(const JudgedFrames& frames, const TargetPlate& mounted_plate,
                                       const TargetState& set, double contrast) {
  const auto average = frames.average();
  if (!average) return;
  const RadiometricScale& scale = grey() ? scale_of_counts() : camera_.info().scale;
  const int cut_off = saturation_behind_.learn(average->picture, scale, mounted_plate, average->registration, contrast);
  if (cut_off == 0) return;
  note_(
      fmt::format("{}: behind the stages {} pixels of the triangles are at the lowest or highest level of the picture: "
                  "they clip the set contrast of {:+.3f} K",
                  plate_and_mounting(set), cut_off, set.delta_t_k));
}

int SetUpStep::saturated_samples(const Frame& frame, const cv::Rect& window) const {
  const int beyond = cut_off_samples(frame, window);
  if (!behind_stages(frame) || judged_samples_per_pixel(frame) > 1) return beyond;
  return std::max(beyond, saturation_behind_.saturated_pixels(as_judged(frame), window));
}

Result<SeenContrast> SetUpStep::contrast(const TargetPlate& mounted_plate, const Registration& registration,
                                         const TargetState& set, const PresentedTarget& said, std::stop_token stop) {
  JudgedFrames behind(mounted_plate, registration, options_.min_reference_px, options_.contrast_frames);
  ScanFrames scanned;
  const auto picture =
      average(options_.contrast_frames, std::move(stop), [&](const Frame& frame, const cv::Mat1d& kelvin) {
        behind.add(frame);
        scanned.add(frame, kelvin);
      });
  if (!picture) return tl::unexpected(picture.error());
  if (auto moves = scan_.look(scanned, mounted_plate, registration, options_.registration); !moves)
    return tl::unexpected(moves.error());
  // With noise below half a count, the result depends on rounding.
  if (!grey() && noise_counts_.value_or(0) >= dithering_noise_steps && picture->temporal_noise_k > 0)
    constancy_.noise.push_back({set.delta_t_k, picture->temporal_noise_k, picture->lag1_correlation,
                                options_.contrast_frames, std::min(picture->kelvin.rows, picture->kelvin.cols)});
  if (options_.learn_response && !grey()) {
    const SetUpPicture seen{*picture, options_.contrast_frames, mounted_plate, registration, set};
    for (const auto& [name, learnt] : options_.learn_response(seen)) learnt_response_[name] = learnt;
  }
  const auto measured = effective_contrast(picture->kelvin, mounted_plate, registration, options_.min_reference_px,
                                           level_estimate(options_.contrast_unit));
  if (!measured) return fail("measuring the effective contrast", measured.error());
  note_saturation(*picture, mounted_plate, registration, set, measured->value);
  if (!(measured->value * set.delta_t_k > 0)) {
    const auto surround = grey() ? std::nullopt : camera_.info().scale.counts(cv::mean(picture->kelvin)[0]);
    return fail(ErrorCode::calibration,
                unexpected_sign(set.delta_t_k, *measured, options_.contrast_unit,
                                surround ? camera_.info().scale.kelvin_per_count(*surround) : std::nullopt));
  }
  const auto judged = behind.scale(memory_ratio_);
  if (!judged) return fail(plate_and_mounting(set), judged.error());
  if (*judged) note_saturation_behind(behind, mounted_plate, set, measured->value * (*judged)->gain);
  Result<SeenContrast> seen = grey() ? in_grey_levels(*picture, *measured, set, said) : in_kelvin(*measured, set);
  if (!seen) return seen;
  judge_by(*judged, set, *seen);
  if (grey() || set.wait != ContrastWait::settled) return seen;
  const auto outlines = large_outlines(mounted_plate, registration, options_.registration.min_triangle_px);
  if (!outlines.empty())
    seen->large = fit_place(picture->kelvin, outlines, registration.blur_px, registration.pixel({0, 0}));
  return seen;
}

void SetUpStep::judge_by(const std::optional<JudgedScale>& judged, const TargetState& set, SeenContrast& seen) {
  seen.judged = judged;
  seen.camera_noise_k = seen.noise_k;
  if (!judged) return;
  seen.noise_k *= judged->noise_ratio / std::abs(judged->gain);
  if (grey()) seen.steps = judged->steps;
  const bool noted = std::any_of(noted_contrasts_.begin(), noted_contrasts_.end(),
                                 [&](double contrast) { return contrast == set.delta_t_k; });
  if (noted) return;
  noted_contrasts_.push_back(set.delta_t_k);
  note_(fmt::format(
      "{}, {:+.3f} K: behind the stages the contrast is {:.4g} +- {:.2g} times that of the camera{}; the observer "
      "judges in units of this contrast, with a noise equivalent to {:.4f} K in front of the stages",
      plate_and_mounting(set), set.delta_t_k, judged->gain, judged->gain_error,
      judged->changes ? " and changes from frame to frame" : "", seen.noise_k));
}

Result<double> SetUpStep::gain_of(const Frame& frame, const TargetPlate& mounted_plate,
                                  const Registration& registration, const SeenContrast& seen) const {
  if (!seen.judged || !behind_stages(frame)) return 1;
  if (!seen.judged->changes) return seen.judged->gain;
  return judged_gain(frame, mounted_plate, registration, options_.min_reference_px, *seen.judged);
}

Result<void> SetUpStep::check_contrast(double seen_k, double error_k, const TargetState& set) const {
  const auto allowed = options_.max_contrast_error.find(set.delta_t_k);
  if (allowed == options_.max_contrast_error.end()) return {};
  const double expected_k = options_.air_transmittance.value_or(1) * set.delta_t_k;
  constexpr double certain = 4;  // standard errors
  if (!(std::abs(seen_k - expected_k) - certain * error_k > allowed->second * std::abs(expected_k))) return {};
  return fail(ErrorCode::calibration,
              fmt::format("{}: the camera observes {:.3f} +- {:.3f} K, but {:.3f} K were set ({:+.0f} %, at most "
                          "{:.0f} % are allowed): the target or the temperature scale of the camera is wrong",
                          plate_and_mounting(set), seen_k, error_k, expected_k, 100 * (seen_k / expected_k - 1),
                          100 * allowed->second));
}

Result<SeenContrast> SetUpStep::in_kelvin(const EffectiveContrast& measured, const TargetState& set) const {
  const double seen_k = measured.value / response(set.plate);
  TODBENCH_TRY_VOID(check_contrast(seen_k, measured.standard_error / response(set.plate), set));
  const double deviation = seen_k / set.delta_t_k - 1;
  if (std::abs(deviation) > 0.2 && std::abs(seen_k - set.delta_t_k) > 3 * measured.standard_error) {
    note_(fmt::format("{}: the camera observes {:.3f} K, but {:.3f} K were set ({:+.0f} %)", plate_and_mounting(set),
                      seen_k, set.delta_t_k, 100 * deviation));
  }
  SeenContrast seen{.contrast_k = seen_k, .noise_k = noise_of_frame_k_};
  seen.references = measured.references;
  for (ReferenceTriangle& reference : seen.references) reference.value /= response(set.plate);
  if (measured.triangles > 1) seen.standard_error_k = measured.standard_error / response(set.plate);
  return seen;
}

Result<SeenContrast> SetUpStep::own_contrast(std::span<const Frame> frames, const TargetPlate& mounted_plate,
                                             const Registration& registration, const TargetState& set,
                                             SeenContrast seen) const {
  constexpr double visible = 5;  // standard errors
  cv::Mat1d sum;
  for (const Frame& frame : frames) {
    auto kelvin = window_kelvin(frame, {{0, 0}, frame.counts.size()});
    if (!kelvin) return tl::unexpected(kelvin.error());
    if (sum.empty())
      sum = *kelvin;
    else
      sum += *kelvin;
  }
  const cv::Mat1d mean = sum / static_cast<double>(frames.size());
  seen.small_contrast_k.reset();
  const auto measured = effective_contrast(mean, mounted_plate, registration, options_.min_reference_px);
  if (!measured) return fail("measuring the contrast of a presentation", measured.error());
  if (!(measured->value * set.delta_t_k > 0) || std::abs(measured->value) < visible * measured->standard_error)
    return seen;
  seen.contrast_k = measured->value / response(set.plate);
  seen.references = measured->references;
  for (ReferenceTriangle& reference : seen.references) reference.value /= response(set.plate);
  if (measured->triangles > 1) seen.standard_error_k = measured->standard_error / response(set.plate);
  seen.small_contrast_k = contrast_of_small_triangles(mean, mounted_plate, registration, options_.min_reference_px);
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
  if (seen.steps.noise_steps() >= dithering_noise_steps && measured.triangles > 1)
    constancy_.noise.push_back(
        {.set_delta_t_k = set.delta_t_k,
         .noise_k = seen.steps.noise_steps() * seen.steps.step_levels / std::abs(seen.levels_per_k),
         .lag1_correlation = picture.lag1_correlation,
         .frames = options_.contrast_frames,
         .lines = std::min(picture.kelvin.rows, picture.kelvin.cols),
         .triangles = measured.triangles,
         .triangle_scatter = std::sqrt(measured.triangles) * measured.standard_error / std::abs(measured.value)});
  // The coarsest of all contrasts represents the run.
  noise_counts_ = std::min(noise_counts_.value_or(noise_steps), noise_steps);
  if (seen.steps.noise_steps() < dithering_noise_steps) {
    note_(
        fmt::format("{}, {:+.3f} K: the noise of a pixel is {:.2f} steps of {:.2g} grey levels: levels that differ by "
                    "less than a step may look the same",
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
  // The sign must agree too, because a gain does not change its sign.
  if (!(contrast->levels * seen.contrast_k > 0 &&
        std::abs(contrast->levels) >= least_certainty * contrast->standard_uncertainty)) {
    return fail(ErrorCode::calibration,
                fmt::format("{}: the large triangles of frame {} differ from their surround by {:+.2f} +- {:.2f} grey "
                            "levels at {:+.3f} K: their contrast is too small to measure",
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
