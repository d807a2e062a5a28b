// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/time_prediction.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "acquisition/base/try.h"
#include "bench/devices/devices.h"
#include "bench/plan/plan_options.h"
#include "bench/twin/paired_comparison.h"
#include "bench/twin/twin_shapes.h"
#include "sim_devices/prediction/direct_timing.h"
#include "tod/measurement/frame_taker.h"
#include "tod/plate/test_pattern.h"
#include "tod/registration/patch_windows.h"
#include "tod/registration/registration.h"

namespace todbench {
namespace {

constexpr double shapes_per_first_draw = 1.5;  // a first picture creates two of the three shapes of all mountings
/// Time of a complete function over that of a direct estimate with as many draws: it has more sizes (predicted_time).
constexpr double sizes_of_shape = 4.5;
constexpr double fit_s = 0.01;  // of one contrast, both intervals

/// Seconds of each kind of work on one plate.
struct PlateSpeed {
  double first_draw = 0;  ///< a picture with new shapes and tables
  double draw = 0;        ///< a picture at another position
  double frame = 0;       ///< a frame of an unchanged scene, acquired and accumulated
  double registration = 0, contrast = 0;
  double prepare = 0;  ///< observer preparation for all its sizes
  double answers = 0;  ///< all triangles of a frame
};

template <typename Work>
double seconds_of(Work&& work) {
  const double start = thread_seconds();
  work();
  return thread_seconds() - start;
}

/// Numbers of operations on one side.
struct Counts {
  double set_ups = 0;        ///< of one plate
  double presentations = 0;  ///< of one plate, over all contrasts
  double contrasts = 0;
};

/// Times the decisions on the pictures of a presentation, and the preparation for them.
Result<void> time_answers(const TargetPlate& plate, const Registration& registration, const cv::Mat1d& picture,
                          TemplateObserver& observer, const MeasurementOptions& options, double contrast_k,
                          PlateSpeed& speed) {
  for (const auto& t : plate.triangles) {
    Result<std::shared_ptr<const PreparedObserver>> prepared = nullptr;
    speed.prepare += seconds_of(
        [&] { prepared = observer.prepare(t.size_mm * registration.scale_px_per_mm, options.samples_per_pitch); });
    if (!prepared) return tl::unexpected(prepared.error());
    const auto window = patch_window(registration.pixel(t.position_mm), (*prepared)->window_samples());
    if ((window.pixels & cv::Rect({0, 0}, picture.size())) != window.pixels) continue;
    const auto answer = [&] {
      const Patch patch{.kelvin = picture(window.pixels).clone(), .phase = window.phase, .noise_k = 0};
      const RandomStream noise(1, "time_prediction");
      if (options.answers == AnswerKind::graded) {
        (void)(*prepared)->judge(patch, contrast_k, noise, MeasurementOptions::graded_draws);
      } else {
        (void)(*prepared)->choose(patch, contrast_k, noise);
      }
    };
    // The first graded answer creates tables that all later ones use.
    if (options.answers == AnswerKind::graded) speed.prepare += seconds_of(answer);
    speed.answers += seconds_of(answer);
  }
  return {};
}

/// Mean frames per presentation, over the contrasts.
double mean_frames(const MeasurementOptions& options) {
  double sum = 0;
  for (const auto& [contrast, frames] : options.frames_at_contrast) sum += frames;
  return sum / std::max(1.0, static_cast<double>(options.frames_at_contrast.size()));
}

Result<PlateSpeed> speed_on(const TargetPlate& plate, const std::shared_ptr<const SensorModel>& model,
                            TemplateObserver& observer, const MeasurementOptions& options,
                            const ExperimentInputs& inputs, std::stop_token stop) {
  constexpr int frames = 4;
  PlateSpeed speed;
  PlateScene scene;
  scene.plate = plate;
  scene.delta_t_k = 1;
  scene.distance_m = options.distance_m;
  scene.motion = inputs.motion;
  scene.background_k = model->spec().scene_temperature_k;
  std::shared_ptr<const cv::Mat1f> unit;
  speed.first_draw = seconds_of([&] { unit = model->unit_signal(scene); });
  scene.shift_mm = {0.1, 0.2};
  speed.draw = seconds_of([&] { unit = model->unit_signal(scene); });
  const auto holder = std::make_shared<SceneHolder>(scene);
  const auto source = simulated_source(model, holder, "time");
  TODBENCH_TRY_VOID(source->start());
  FrameTakerOptions taker_options;
  taker_options.frames_after_change = 0;
  taker_options.integrity.reject_frozen = false;
  taker_options.integrity.width = source->info().width;
  taker_options.integrity.height = source->info().height;
  FrameTaker taker(*source, taker_options);
  Result<AveragedPicture> averaged = AveragedPicture{};
  speed.frame = seconds_of([&] { averaged = taker.average(frames, stop); }) / frames;
  if (!averaged) return tl::unexpected(averaged.error());
  const cv::Mat1d picture = *unit;
  RegistrationOptions registration = options.registration;
  registration.expected_scale_px_per_mm = 1 / (options.distance_m * options.ifov_mrad);
  Result<Registration> found = Registration{};
  speed.registration = seconds_of([&] { found = register_plate(picture, plate, registration); });
  if (!found) return tl::unexpected(found.error());
  speed.contrast = seconds_of([&] { (void)effective_contrast(picture, plate, *found, options.min_reference_px); });
  TODBENCH_TRY_VOID(time_answers(plate, *found, picture, observer, options, 1, speed));
  return speed;
}

/// Time of the response of the contrast estimator: four mountings at two phases.
double response_s(const PlateSpeed& speed) {
  return shapes_per_first_draw * (speed.first_draw - speed.draw) +
         8 * (speed.draw + speed.registration + speed.contrast);
}

/// Computing time for one plate, without its pictures.
double looking_s(const PlateSpeed& speed, const Counts& counts, double frames_per_presentation) {
  return speed.prepare + counts.set_ups * speed.registration + counts.set_ups * counts.contrasts * speed.contrast +
         counts.presentations * frames_per_presentation * speed.answers;
}

double frames_of(const Plan& plan, const Counts& counts, double frames_per_presentation) {
  return counts.set_ups * (plan.measurement.registration_frames + counts.contrasts * plan.measurement.contrast_frames) +
         counts.presentations * frames_per_presentation;
}

/// Counts of the plate of this index.
Counts counts_of(const Plan& plan, const ExperimentInputs& inputs, std::size_t plate, int phases) {
  Counts counts{.set_ups = static_cast<double>(mountings_of(plan.target, plate)),
                .presentations = 0,
                .contrasts = static_cast<double>(plan.target.delta_t_k.size())};
  counts.presentations = counts.set_ups * counts.contrasts * phases;
  if (plan.schedule.kind == ScheduleKind::adaptive) {
    // Upper limit; the schedule may stop earlier.
    counts.presentations = std::min(counts.presentations * 8, static_cast<double>(plan.schedule.max_presentations) /
                                                                  static_cast<double>(inputs.plates.size()));
  }
  return counts;
}

/// Standard error of ln S75 for binary answers at sizes within a factor of two around it; empty for graded ones.
std::optional<double> expected_error(const Plan& plan, const ExperimentInputs& inputs) {
  if (chosen_answers(plan, inputs.sensor).kind == AnswerKind::graded) return std::nullopt;
  double trials = 0;
  for (std::size_t i = 0; i < inputs.plates.size(); ++i) {
    const Counts counts = counts_of(plan, inputs, i, plan.simulation.phases);
    trials += static_cast<double>(inputs.plates[i].triangles.size()) * counts.presentations / counts.contrasts;
  }
  return 0.65 / std::sqrt(std::max(trials, 1.0));
}

}  // namespace

double needed_draws(const Accuracy& accuracy, double q_eff) {
  if (!(accuracy.standard_error_percent > 0)) return accuracy.noise_draws;
  const double needed = std::pow((0.046 + 0.285 * q_eff) / (accuracy.standard_error_percent / 100), 2);
  return std::max<double>(accuracy.noise_draws, needed);
}

Result<double> predict_estimate_s(const ExperimentInputs& inputs, std::stop_token stop) {
  double sum = 0;
  for (const auto& outlook : inputs.outlooks) {
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
    const double draws = std::min<double>(needed_draws(inputs.accuracy, outlook.q_eff), Accuracy::max_noise_draws);
    TODBENCH_TRY(const double seconds,
                 measured_direct_seconds(inputs.sensor, inputs.effects, inputs.observer, outlook.delta_t_k,
                                         outlook.s75_pitch, draws, inputs.accuracy, inputs.motion));
    sum += seconds;
  }
  return sum;
}

Result<TimePrediction> predict_time(const Plan& plan, const ExperimentInputs& inputs, std::stop_token stop) {
  const auto model = std::make_shared<const SensorModel>(inputs.sensor, inputs.effects, inputs.accuracy, plan.seed);
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  const MeasurementOptions options = simulated_options(plan, inputs);
  const double frames = mean_frames(options);
  TimePrediction out;
  for (std::size_t i = 0; i < inputs.plates.size(); ++i) {
    const TargetPlate& plate = inputs.plates[i];
    const Counts simulated = counts_of(plan, inputs, i, plan.simulation.phases);
    const Counts measured = counts_of(plan, inputs, i, plan.target.phases);
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
    const auto speed = speed_on(plate, model, observer, options, inputs, stop);
    if (!speed) return fail("timing plate " + plate.name, speed.error());
    const double drawing = simulated.presentations * speed->draw + frames_of(plan, simulated, frames) * speed->frame;
    out.simulation_s += response_s(*speed) + looking_s(*speed, simulated, frames) + drawing;
    out.measuring_s +=
        response_s(*speed) + looking_s(*speed, measured, frames) + frames_of(plan, measured, frames) * speed->frame;
    // The twin judges the camera's presentations this many times.
    if (pairs_asked(plan, inputs.sensor) && !plan.camera.id.empty())
      out.measuring_s += measured.presentations * PairedTwinOptions::default_draws * speed->answers;
    if (plan.target.kind == TargetKind::scene) out.measuring_s += measured.presentations * speed->draw;
  }
  out.simulation_s += static_cast<double>(plan.target.delta_t_k.size()) * fit_s;
  const bool shaped = chosen_estimator(plan, inputs.sensor).estimator == FitEstimator::twin_shape;
  for (const auto& outlook : inputs.outlooks) {
    const double draws = std::min<double>(needed_draws(inputs.accuracy, outlook.q_eff), Accuracy::max_noise_draws);
    const auto seconds_with = [&](double noise_draws) {
      return measured_direct_seconds(inputs.sensor, inputs.effects, inputs.observer, outlook.delta_t_k,
                                     outlook.s75_pitch, noise_draws, inputs.accuracy, inputs.motion);
    };
    TODBENCH_TRY(const auto seconds, seconds_with(draws));
    out.simulation_s += seconds;
    if (!shaped) continue;
    // Function of the curve, and again for a separate camera: the same draws for every tolerance.
    TODBENCH_TRY(const auto table_s, seconds_with(draws_of_twin_shape(expected_error(plan, inputs), inputs.accuracy)));
    out.simulation_s += sizes_of_shape * table_s;
    out.measuring_s += sizes_of_shape * table_s;
    if (plan.schedule.kind != ScheduleKind::adaptive) continue;
    // Functions of the stopping rule, for camera and twin (stopping_tables()).
    TODBENCH_TRY(const auto stopping_s,
                 seconds_with(draws_of_twin_shape(plan.schedule.half_width_percent / 196, inputs.accuracy)));
    out.simulation_s += sizes_of_shape * stopping_s;
    out.measuring_s += sizes_of_shape * stopping_s;
  }
  return out;
}

}  // namespace todbench
