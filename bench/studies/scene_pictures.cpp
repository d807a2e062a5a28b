// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/studies/scene_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "acquisition/base/try.h"
#include "bench/studies/staged_scene.h"
#include "sim_devices/atmosphere/radiative_path.h"
#include "sim_devices/sensor/effect_distortion.h"
#include "sim_devices/sensor/effect_image_dance.h"
#include "sim_devices/sensor/effect_quantisation.h"
#include "sim_devices/sensor/effect_readout.h"
#include "sim_devices/sensor/effect_turbulence.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

constexpr int display_factor = 8;

SensorPlan with_decision(SensorPlan plan, Effect effect, Decision decision) {
  for (auto& d : plan.decisions) {
    if (d.effect == effect) d.decision = decision;
  }
  return plan;
}

/// Side of the displayed square in pitches, even.
int field_of(const ScenePicturesTask& task, const SensorSpec& spec) {
  const int most = std::max(2, std::min(spec.width, spec.height) / 2 * 2);
  if (task.field_pitch > 0) return std::min(task.field_pitch + task.field_pitch % 2, most);
  FieldScene targets = task.scene;
  const auto none = [](const SceneRegion& region) { return !region.target; };
  targets.regions.erase(std::remove_if(targets.regions.begin(), targets.regions.end(), none), targets.regions.end());
  const bool any = !targets.regions.empty();
  const cv::Size2d extent = extent_m(any ? targets : task.scene);
  const double pitches = 1.5 * std::max(extent.width, extent.height) * 1e3 / (task.view.range_m * spec.ifov_mrad()) + 6;
  return std::min(2 * static_cast<int>(std::ceil(std::clamp(pitches, 16.0, 1e6) / 2)), most);
}

/// The central `field` pitches of a picture of all detectors.
cv::Rect field_rect(const SensorSpec& spec, int field, int per_pitch) {
  return {(spec.width - field) / 2 * per_pitch, (spec.height - field) / 2 * per_pitch, field * per_pitch,
          field * per_pitch};
}

/// Draws the scene alone on a fine grid: polygons as means over its cells, pictures by the nearest element.
cv::Mat1d bare_scene(const ScenePicturesTask& task, const SensorSpec& fine, const RadianceScale& scale,
                     const SceneView& view, cv::Size size) {
  if (!task.scene.picture) return SceneImager::means(edges_in_samples(task.scene, scale, fine, view, size), size);
  const cv::Mat1d levels = picture_levels_k(task.scene, scale);
  const double samples_per_element =
      task.scene.picture->element_m * 1e3 / (view.range_m * fine.ifov_mrad()) * fine.samples_per_pitch();
  cv::Mat1d out(size, 0.0);
  for (int j = 0; j < size.height; ++j) {
    for (int i = 0; i < size.width; ++i) {
      const double n = fine.samples_per_pitch();
      const int x = static_cast<int>(std::lround(
          (i - (size.width - 1) / 2.0 - view.centre_pitch.x * n) / samples_per_element + (levels.cols - 1) / 2.0));
      const int y = static_cast<int>(std::lround(
          (j - (size.height - 1) / 2.0 - view.centre_pitch.y * n) / samples_per_element + (levels.rows - 1) / 2.0));
      if (x >= 0 && y >= 0 && x < levels.cols && y < levels.rows) out(j, i) = levels(y, x);
    }
  }
  return out;
}

cv::Mat1f as_float(const cv::Mat1d& picture, double factor) {
  cv::Mat1f out;
  picture.convertTo(out, CV_32F, factor);
  return out;
}

/// Contrast of the target, or the largest of the scene.
double contrast_of(const std::optional<TargetSignature>& signature, const cv::Mat1d& signal) {
  if (signature && signature->dt_rss_k() > 0) return signature->dt_rss_k();
  double low = 0, high = 0;
  cv::minMaxLoc(signal, &low, &high);
  return std::max(std::abs(low), std::abs(high));
}

EffectPlan planned(const ScenePicturesTask& task, double contrast_k) {
  TemplateObserver observer(task.observer, triangle_alternatives());
  if (contrast_k > 0) {
    auto plan = plan_effects(task.sensor, observer, {.delta_t_k = {contrast_k}, .motion = task.motion}, task.effects);
    if (plan) return *std::move(plan);
  }
  EffectPlan all;
  all.plan = full_plan(task.sensor, task.effects.skip, task.effects.force, task.motion);
  all.warnings.push_back(fmt::format("at {:.3g} K there is no threshold size: every effect is simulated", contrast_k));
  return all;
}

/// The signal of the samples, exposure by exposure if the air moves the image.
Result<cv::Mat1d> danced_signal_k(const SceneImager& imager, const SensorSpec& spec, const ScenePicturesTask& task,
                                  const RadianceScale& scale, SceneView view, cv::Size size,
                                  const std::vector<cv::Point2d>& displacements_pitch) {
  if (dance_sd_pitch(spec) == 0) return scene_signal_k(imager, spec, task.scene, scale, view, size);
  cv::Mat1d sum(size, 0.0);
  const cv::Point2d still = view.centre_pitch;
  for (const cv::Point2d& displacement : displacements_pitch) {
    view.centre_pitch = still + displacement;
    const auto signal = scene_signal_k(imager, spec, task.scene, scale, view, size);
    if (!signal) return signal;
    sum += *signal / static_cast<double>(displacements_pitch.size());
  }
  return sum;
}

/// Signals of the frames that the stages remember, in kelvin, and of the picture itself.
Result<std::vector<cv::Mat1f>> signals_for_stages(const SceneImager& imager, const SensorSpec& spec,
                                                  const ScenePicturesTask& task, const RadianceScale& scale,
                                                  const SceneView& view, const cv::Mat1f& last, double transmittance,
                                                  const std::vector<cv::Point2d>& displacements_pitch) {
  int memory = 0;
  for (const auto& stage : task.stages()) memory += stage->memory_frames();
  const cv::Point2d step =
      cv::Point2d(task.motion.x_mrad_s, task.motion.y_mrad_s) / (spec.ifov_mrad() * spec.frame_rate_hz);
  std::vector<cv::Mat1f> signals;
  for (int k = -memory; k < 0; ++k) {
    if (!task.motion.moving()) {
      signals.push_back(last);
      continue;
    }
    SceneView earlier = view;
    earlier.centre_pitch += step * static_cast<double>(k);
    TODBENCH_TRY(const auto signal,
                 danced_signal_k(imager, spec, task, scale, earlier,
                                 {spec.width * spec.samples_per_pitch(), spec.height * spec.samples_per_pitch()},
                                 displacements_pitch));
    signals.push_back(as_float(signal, transmittance));
  }
  signals.push_back(last);
  return signals;
}

std::vector<AirDecision> air_decisions(const ScenePicturesTask& task, const ScenePictures& out, double level_shift_k) {
  std::vector<AirDecision> decisions;
  const double lost_percent = 100 * (1 - out.transmittance);
  const bool thin = lost_percent == 0;
  decisions.push_back(
      {"transmittance", thin ? Decision::skip : Decision::simulate,
       thin ? "the air does not reduce the contrast"
            : fmt::format("{:.3g} % of the contrast is lost over {:g} m", lost_percent, task.view.range_m)});
  const bool clipped = reaches_an_end(task.sensor, out.apparent_dt_k, out.background_k);
  decisions.push_back(
      {"path_radiance", level_shift_k != 0 || clipped ? Decision::simulate : Decision::skip,
       level_shift_k != 0
           ? fmt::format("shifts scene and background by the same {:.3g} K, which sets their level in counts{}",
                         level_shift_k, clipped ? "; the contrast reaches the lowest or highest count" : "")
           : "the path adds as much radiance as it takes from the background: the contrast does not change"});
  for (const auto& d : out.effects.plan.decisions) {
    if (is_of_air(d.effect)) decisions.push_back({std::string(to_string(d.effect)), d.decision, d.reason});
  }
  return decisions;
}

std::optional<TurbulenceSeen> turbulence_seen(const SensorSpec& sensor) {
  const auto path = turbulent_path(sensor);
  if (!path) return std::nullopt;
  const double aperture_m = sensor.focal_length_mm / sensor.f_number / 1000;
  const double tilt_mrad = tilt_sd_mrad(*path, aperture_m);
  return TurbulenceSeen{
      .path = *path,
      .r0_m = fried_spherical_m(*path),
      .mtf_at_nyquist = long_exposure_mtf(*path, 0.5 * sensor.samples_per_pitch() / sensor.ifov_mrad()),
      .tilt_sd_mrad = tilt_mrad,
      .tilt_sd_pitch = tilt_mrad / sensor.ifov_mrad()};
}

/// Filters of the second picture.
std::string optics_note(const SensorPlan& plan) {
  std::string note = plan.simulates(Effect::turbulence) ? "turbulence, diffraction, and aberration if it is simulated"
                                                        : "diffraction, and aberration if it is simulated";
  if (plan.simulates(Effect::motion) || plan.simulates(Effect::exposure))
    note += "; smear of the motion by time constant and exposure";
  return note;
}

/// Air and signature of the scene, and the effects planned for the contrast behind the air. The scene itself is imaged
/// with every planned effect.
Result<ScenePictures> behind_air(const ScenePicturesTask& task, const RadianceScale& scale) {
  TODBENCH_TRY_VOID(validate(task.scene));
  if (!(task.view.range_m > 0)) return fail(ErrorCode::invalid_input, "the range must be above 0 m");
  const auto tau = task.air.air.at(task.view.range_m);
  if (!tau) {
    return fail(ErrorCode::invalid_input, fmt::format("the air's table ends at {:g} m and does not cover {:g} m",
                                                      task.air.air.end_m(), task.view.range_m));
  }
  ScenePictures out;
  out.transmittance = *tau;
  out.signature = target_signature(task.scene, scale);
  const auto radiance = background_radiance(task.scene, scale.band);
  const double air_k = task.air.air_k.value_or(task.scene.background_k);
  const double seen = *tau * radiance + path_radiance(scale.band, air_k, *tau);
  out.background_k = scale.calibration_k + scale.kelvin(seen - band_radiance(scale.band, scale.calibration_k));
  cv::Mat1d levels;
  if (task.scene.picture) {
    levels = picture_levels_k(task.scene, scale);
  } else {
    for (const auto& p : levels_k(task.scene, scale)) levels.push_back(p.level);
  }
  out.apparent_dt_k = *tau * contrast_of(out.signature, levels);
  out.effects = planned(task, out.apparent_dt_k);
  if (distorts(task.sensor)) out.effects.warnings.emplace_back("the pictures do not show the distortion of the lens");
  if (out.effects.plan.simulates(Effect::readout) && task.sensor.row_time_us > 0 && task.scene.picture)
    out.effects.warnings.emplace_back(
        "the pictures of a radiometric picture do not show that rows are read one after another while it moves");
  out.air = air_decisions(task, out, scale.kelvin(seen - radiance));
  out.turbulence = turbulence_seen(task.sensor);
  return out;
}

/// A scene in front of a camera. Borrowed for the call.
struct ImagedScene {
  const ScenePicturesTask& task;
  const RadianceScale& scale;
  const SensorPlan& plan;
  const SensorModel& model;
  double transmittance, background_k;
  std::vector<cv::Point2d> displacements_pitch;  ///< by the air, of each exposure
  int field;                                     ///< side of the displayed square, in pitches
};

/// Pictures on a grid that is finer than the detectors.
struct FinePictures {
  cv::Mat1f scene, optics, detector;
  double pixels_per_pitch = 1;
};

Result<FinePictures> fine_pictures(const ImagedScene& shown) {
  const ScenePicturesTask& task = shown.task;
  const SensorSpec& spec = shown.model.spec();
  // An even number of cells per pitch.
  const int per_pitch = std::clamp(1024 / shown.field / 2 * 2, 2, 16);
  SensorSpec fine = spec;
  fine.microscan = per_pitch;
  fine.super_resolution_frames = 0;
  fine.field_delay_ms = 0;  // fields are a matter of the samples
  const cv::Size size(shown.field * per_pitch, shown.field * per_pitch);
  SceneView view = task.view;
  // Centre of the displayed field relative to that of the frame.
  view.centre_pitch += cv::Point2d((spec.width - shown.field) % 2, (spec.height - shown.field) % 2) / 2;
  SceneView read_out = view;
  read_out.readout_slope = readout_slope(spec, task.motion);
  const auto filtered = [&](const SensorPlan& filters) {
    return danced_signal_k(SceneImager(fine, filters, task.accuracy, task.motion), fine, task, shown.scale, read_out,
                           size, shown.displacements_pitch);
  };
  TODBENCH_TRY(const auto behind_optics, filtered(with_decision(shown.plan, Effect::detector, Decision::skip)));
  TODBENCH_TRY(const auto behind_detector, filtered(shown.plan));
  return FinePictures{as_float(bare_scene(task, fine, shown.scale, view, size), shown.transmittance),
                      as_float(behind_optics, shown.transmittance), as_float(behind_detector, shown.transmittance),
                      static_cast<double>(per_pitch)};
}

/// Pictures of the samples of the whole frame.
struct SampledPictures {
  cv::Mat1f signal, noisy, frame, judged;  ///< `judged`: behind the stages, the frame without them
  std::optional<double> gain;              ///< of the stages
};

Result<SampledPictures> sampled_pictures(const ImagedScene& shown, cv::Rect samples) {
  const ScenePicturesTask& task = shown.task;
  const SensorModel& model = shown.model;
  const SensorSpec& spec = model.spec();
  const SceneImager imager(spec, shown.plan, task.accuracy, task.motion);
  SceneView view = task.view;
  view.readout_slope = readout_slope(spec, task.motion);
  TODBENCH_TRY(const auto signal,
               danced_signal_k(imager, spec, task, shown.scale, view, model.size(), shown.displacements_pitch));
  const SensorModel undisplayed(
      task.sensor,
      with_decision(with_decision(shown.plan, Effect::display, Decision::skip), Effect::quantisation, Decision::skip),
      task.accuracy, task.seed);
  SampledPictures out;
  out.signal = as_float(signal, shown.transmittance);
  out.noisy = undisplayed.picture(out.signal, 1, shown.background_k, 0);
  out.frame = out.judged = model.picture(out.signal, 1, shown.background_k, 0);
  if (!task.stages) return out;
  TODBENCH_TRY(const auto signals, signals_for_stages(imager, spec, task, shown.scale, view, out.signal,
                                                      shown.transmittance, shown.displacements_pitch));
  TODBENCH_TRY(const auto staged, behind_stages(model, task.stages, signals, shown.background_k, samples));
  out.judged = staged.kelvin;
  out.gain = staged.gain;
  return out;
}

/// The stages of the page.
std::vector<SceneStage> listed(const ImagedScene& shown, const FinePictures& fine, const SampledPictures& sampled,
                               cv::Rect samples) {
  const ScenePicturesTask& task = shown.task;
  const SensorSpec& spec = shown.model.spec();
  const int n = spec.samples_per_pitch();
  const auto displayed = [&](const cv::Mat1f& picture) {
    cv::Mat1f larger;
    cv::resize(picture(samples), larger, {}, display_factor, display_factor, cv::INTER_NEAREST);
    return larger;
  };
  const cv::Mat1f judged = displayed(sampled.judged);
  cv::Mat1f seen_by_observer;
  cv::GaussianBlur(judged, seen_by_observer, {}, task.observer.blur_sigma_samples * display_factor, 0,
                   cv::BORDER_REFLECT_101);
  const double displayed_per_pitch = n * display_factor;
  const std::string air_note =
      fmt::format("after {:.0f} m of air, transmittance {:.3f}", task.view.range_m, shown.transmittance);
  std::vector<SceneStage> stages{
      {"1-scene", "At the sensor", air_note, fine.scene, fine.pixels_per_pitch},
      {"2-optics", "Behind the optics", optics_note(shown.plan), fine.optics, fine.pixels_per_pitch},
      {"3-detector", "On the detectors", "mean over the sensitive area around each position", fine.detector,
       fine.pixels_per_pitch},
      {"4-sampled", "Sampled", fmt::format("{} {} per pitch and axis", n, n == 1 ? "sample" : "samples"),
       sampled.signal(samples).clone(), static_cast<double>(n)},
      {"5-noise", "With noise",
       fmt::format("temporal noise of {:.3g} K per sample and the other noise of the sensor", spec.netd_k),
       sampled.noisy(samples).clone(), static_cast<double>(n)},
      {"6-display", "On the display", "in whole counts, samples reconstructed by the display", displayed(sampled.frame),
       displayed_per_pitch}};
  if (sampled.gain)
    stages.push_back({"7-package", "Behind the package",
                      fmt::format("divided by the gain of the contrast, {:.3g}", *sampled.gain), judged,
                      displayed_per_pitch});
  stages.push_back({sampled.gain ? "8-observer" : "7-observer", "After the observer's filter",
                    fmt::format("blur of display and eye, sigma {:g} samples", task.observer.blur_sigma_samples),
                    seen_by_observer, displayed_per_pitch});
  return stages;
}

}  // namespace

Result<ScenePictures> scene_pictures(const ScenePicturesTask& task) {
  const RadianceScale scale{{task.sensor.wavelength_min_um, task.sensor.wavelength_max_um},
                            task.sensor.scene_temperature_k};
  TODBENCH_TRY(ScenePictures out, behind_air(task, scale));
  const SensorModel model(task.sensor, out.effects.plan, task.accuracy, task.seed);
  const SensorSpec& spec = model.spec();
  ImagedScene shown{.task = task,
                    .scale = scale,
                    .plan = out.effects.plan,
                    .model = model,
                    .transmittance = out.transmittance,
                    .background_k = out.background_k,
                    .displacements_pitch = model.displacements_px(0),
                    .field = field_of(task, spec)};
  for (cv::Point2d& displacement : shown.displacements_pitch) displacement /= spec.samples_per_pitch();
  const cv::Rect samples = field_rect(spec, shown.field, spec.samples_per_pitch());
  TODBENCH_TRY(const auto sampled, sampled_pictures(shown, samples));
  TODBENCH_TRY(const auto fine, fine_pictures(shown));
  out.stages = listed(shown, fine, sampled, samples);
  out.frame = sampled.judged;
  out.judged_gain = sampled.gain;
  double low = 0, high = 0;
  cv::minMaxLoc(sampled.noisy(samples), &low, &high);
  out.grey_low_k = low;
  out.grey_high_k = high > low ? high : low + 1;
  return out;
}

cv::Mat1b grey_picture(const cv::Mat1f& kelvin, double low_k, double high_k, int least_px) {
  cv::Mat1b grey;
  kelvin.convertTo(grey, CV_8U, 255 / (high_k - low_k), -255 * low_k / (high_k - low_k));
  const int factor = std::max(1, (least_px + std::max(grey.rows, grey.cols) - 1) / std::max(grey.rows, grey.cols));
  cv::Mat1b larger;
  cv::resize(grey, larger, {}, factor, factor, cv::INTER_NEAREST);
  return larger;
}

}  // namespace todbench
