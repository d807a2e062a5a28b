// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/dynamic_trials.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "acquisition/base/try.h"
#include "sim_devices/prediction/trial_plate.h"
#include "sim_devices/sensor/effect_quantisation.h"
#include "sim_devices/sensor/effect_readout.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/measurement/lag_differences.h"
#include "tod/plate/test_pattern.h"
#include "tod/registration/registration.h"

namespace todbench {
namespace {

/// The frames of a pass.
struct MovingPass {
  std::vector<cv::Mat1f> frames;
  PlateScene scene;    ///< of the first
  double step_px = 0;  ///< from frame to frame, along x
};

/// Number of frames that the stages remember.
int lead_frames(const DynamicTrialOptions& options) {
  if (!options.stages) return 0;
  int sum = 0;
  const auto stages = options.stages();
  for (const auto& stage : stages) sum += stage->memory_frames();
  return sum;
}

/// Contrast and noise behind the stages, relative to those in front of them.
struct StageScale {
  double gain = 1, noise_ratio = 1;
};

Result<cv::Mat1f> through(const std::vector<std::unique_ptr<ChainStage>>& stages, cv::Mat1f picture) {
  for (const auto& stage : stages) {
    TODBENCH_TRY(picture, stage->process(picture));
  }
  return picture;
}

Registration known_registration(const PlateScene& scene, const SensorModel& model) {
  const auto at = [&](cv::Point2d mm) { return scene_pixel(scene, mm, model.spec().ifov_mrad(), model.size()); };
  const cv::Point2d origin = at({0, 0}), x = at({1, 0}) - origin, y = at({0, 1}) - origin;
  Registration out;
  out.plate_to_pixel = cv::Matx33d(x.x, y.x, origin.x, x.y, y.y, origin.y, 0, 0, 1);
  out.scale_px_per_mm = std::sqrt(std::abs(x.cross(y)));
  return out;
}

/// Measures the scale at the marks of the plate at rest. Its frames have random numbers after those of all passes.
/// Errors: those of the stages; `not_identifiable` (the stages show no contrast).
Result<StageScale> stage_scale(const SensorSpec& camera, const TargetPlate& plate, const DynamicTrialOptions& options) {
  constexpr int frames = 32;
  constexpr double least_mark_pitch = 9;
  if (!options.stages) return StageScale{};
  const SensorModel model(camera, full_plan(camera, {}, {}), options.accuracy, options.seed);
  PlateScene scene;
  scene.plate = plate;
  scene.delta_t_k = options.delta_t_k;
  scene.distance_m = trial_distance_m;
  const Registration registration = known_registration(scene, model);
  const auto stages = options.stages();
  const int lead = lead_frames(options), first = options.passes * (options.frames + lead);
  LagDifferences in_front(frames), behind(frames);
  cv::Mat1d mean_in_front = cv::Mat1d::zeros(model.size()), mean_behind = mean_in_front.clone();
  for (int k = 0; k < lead + frames; ++k) {
    cv::Mat1f picture;
    model.expose(scene, static_cast<std::uint64_t>(first + k)).convertTo(picture, CV_32F);
    TODBENCH_TRY(const auto answer, through(stages, picture));
    if (k < lead) continue;
    const cv::Mat1d before(picture), after(answer);
    mean_in_front += before / frames;
    mean_behind += after / frames;
    in_front.add(static_cast<std::uint64_t>(k), before);
    behind.add(static_cast<std::uint64_t>(k), after);
  }
  TODBENCH_TRY(const auto shown,
               effective_contrast(mean_in_front, plate, registration, least_mark_pitch, LevelEstimate::mean));
  TODBENCH_TRY(const auto judged,
               effective_contrast(mean_behind, plate, registration, least_mark_pitch, LevelEstimate::mean));
  StageScale out{.gain = judged.value / shown.value};
  if (!std::isfinite(out.gain) || out.gain == 0)
    return fail(ErrorCode::not_identifiable, "after the processing stages, the large triangles have no contrast");
  if (in_front.variance() > 0) out.noise_ratio = std::sqrt(behind.variance() / in_front.variance());
  return out;
}

Result<MovingPass> exposed_pass(const SensorModel& model, const TargetPlate& plate, const DynamicTrialOptions& options,
                                double gain, double speed_mrad_s, int index) {
  // The streams are those of camera_trials(): a target at rest gives the answers of a still picture, bit for bit.
  const RandomStream phases = RandomStream(options.seed, "camera_trials.phase").sub(static_cast<std::uint64_t>(index));
  const double along = index % 2 == 0 ? speed_mrad_s : -speed_mrad_s;
  const SensorSpec& spec = model.spec();
  MovingPass pass;
  pass.step_px = along / spec.ifov_mrad() / spec.frame_rate_hz;
  pass.scene.plate = plate;
  pass.scene.delta_t_k = options.delta_t_k;
  pass.scene.distance_m = trial_distance_m;
  pass.scene.centre_px = {phases.uniform(0) - 0.5, phases.uniform(1) - 0.5};
  pass.scene.motion = {.x_mrad_s = along, .y_mrad_s = 0};
  auto stages = options.stages ? options.stages() : std::vector<std::unique_ptr<ChainStage>>();
  const int lead = lead_frames(options);
  for (int k = -lead; k < options.frames; ++k) {
    PlateScene scene = pass.scene;
    scene.centre_px.x += pass.step_px * k;
    // Frames in front of a pass have random numbers after those of all passes.
    const int frame = k >= 0 ? index * options.frames + k : options.passes * options.frames + index * lead + (k + lead);
    cv::Mat1f picture;
    model.expose(scene, static_cast<std::uint64_t>(frame)).convertTo(picture, CV_32F);
    TODBENCH_TRY(const auto answer, through(stages, picture));
    if (k < 0) continue;
    // In units of the judged contrast; an offset that the stages add to every pixel is ignored.
    cv::Mat1f kelvin;
    answer.convertTo(kelvin, CV_32F, spec.kelvin_per_count / gain, spec.offset_k - scene.background_k);
    pass.frames.push_back(std::move(kelvin));
  }
  return pass;
}

void add_answers(const SequenceJudge& judge, const MovingPass& pass, const SensorModel& model, double noise_k,
                 int index, const RandomStream& trial, DynamicTrials& trials) {
  for (const SequenceObserver kind : all_sequence_observers) {
    const auto k = static_cast<std::size_t>(kind);
    std::vector<Level> levels(judge.sizes());
    for (std::size_t t = 0; t < 4 * judge.sizes(); ++t) {  // the marks follow
      const PlateTriangle& triangle = pass.scene.plate.triangles[t];
      const cv::Point2d place =
          as_read_out(scene_pixel(pass.scene, triangle.position_mm, model.spec().ifov_mrad(), model.size()),
                      readout_slope(model.spec(), pass.scene.motion), 0.5 * (model.size().height - 1));
      SeenSequence seen{.frames = pass.frames, .places = {}, .contrast_k = pass.scene.delta_t_k, .noise_k = noise_k};
      for (std::size_t f = 0; f < pass.frames.size(); ++f)
        seen.places.push_back(place + cv::Point2d(pass.step_px * static_cast<double>(f), 0));
      const int answer = judge.choose(kind, t / 4, seen, trial.sub(k).sub(t));
      Level& level = levels[t / 4];
      level.size = triangle.size_mm;
      level.correct += answer == static_cast<int>(triangle.apex) ? 1 : 0;
      level.total += 1;
      level.cluster = index;
    }
    trials.levels[k].insert(trials.levels[k].end(), levels.begin(), levels.end());
  }
}

Result<void> check_dynamic(const SensorSpec& sensor, const DynamicTrialOptions& options) {
  const auto refuse = [](const std::string& why) { return fail(ErrorCode::invalid_input, why); };
  TODBENCH_TRY_VOID(require_square_pixels(sensor, "a trial with a moving target"));
  if (options.sizes_pitch.empty() || options.speeds_mrad_s.empty() || options.passes < 2 || options.frames < 1)
    return refuse("dynamic trials need at least one size, one speed, two passes and one frame");
  for (const double size : options.sizes_pitch) {
    if (!(size > 0.1 && size < 40)) return refuse("dynamic trials need sizes of 0.1 to 40 pitches");
  }
  if (!(std::abs(options.delta_t_k) > 0)) return refuse("a contrast of 0 K has no threshold");
  if (!sensor.modules.empty()) return refuse("dynamic trials do not run the [[module]] of a sensor");
  if (sensor.samples_per_pitch() != 1)
    return refuse("dynamic trials need a camera without microscan and super-resolution");
  for (const double speed : options.speeds_mrad_s) {
    const double px = speed / sensor.ifov_mrad() / sensor.frame_rate_hz;
    // A faster target leaves the picture.
    if (!(px >= 0 && px <= 5)) return refuse("dynamic trials need speeds of 0 to 5 pixels per frame");
  }
  if (reaches_an_end(sensor, options.delta_t_k, PlateScene{}.background_k))
    return refuse("a contrast of " + std::to_string(options.delta_t_k) +
                  " K reaches the lowest or highest count of the camera, so its frames are clipped");
  return {};
}

}  // namespace

Result<std::vector<DynamicTrials>> dynamic_trials(const SensorSpec& sensor, TemplateObserver& observer,
                                                  const DynamicTrialOptions& options) {
  TODBENCH_TRY_VOID(check_dynamic(sensor, options));
  const double fastest = *std::max_element(options.speeds_mrad_s.begin(), options.speeds_mrad_s.end());
  const double reach_px =
      fastest / sensor.ifov_mrad() / sensor.frame_rate_hz * (options.frames - 1 + lead_frames(options));
  const TargetPlate plate = trial_plate(options.sizes_pitch, sensor.ifov_mrad());
  const SensorSpec camera = cropped_to(sensor, plate, static_cast<int>(std::ceil(reach_px)));
  TODBENCH_TRY(auto judge, SequenceJudge::prepare(observer, options.sizes_pitch));
  const RandomStream internal(options.seed, "camera_trials.internal");
  TODBENCH_TRY(const auto scale, stage_scale(camera, plate, options));
  const double noise_k =
      std::hypot(camera.netd_k, camera.kelvin_per_count / std::sqrt(12.0)) * scale.noise_ratio / std::abs(scale.gain);
  std::vector<DynamicTrials> found;
  for (const double speed : options.speeds_mrad_s) {
    // The model keeps a chain for each direction of a speed; another speed needs none of them.
    const SensorModel model(camera, full_plan(camera, {}, {}, {.x_mrad_s = speed, .y_mrad_s = 0}), options.accuracy,
                            options.seed);
    DynamicTrials trials;
    trials.speed_mrad_s = speed;
    trials.speed_px = speed / camera.ifov_mrad() / camera.frame_rate_hz;
    for (int p = 0; p < options.passes; ++p) {
      if (options.stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
      TODBENCH_TRY(const auto pass, exposed_pass(model, plate, options, scale.gain, speed, p));
      add_answers(judge, pass, model, noise_k, p, internal.sub(static_cast<std::uint64_t>(p) * 16), trials);
    }
    found.push_back(std::move(trials));
  }
  return found;
}

}  // namespace todbench
