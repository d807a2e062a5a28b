// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/alignment.h"

#include <algorithm>
#include <cmath>

#include "acquisition/base/host_clock.h"
#include "acquisition/base/try.h"
#include "bench/devices/devices.h"
#include "bench/devices/observed_source.h"
#include "bench/plan/plan_options.h"
#include "bench/report/number_format.h"
#include "bench/twin/experiment_inputs.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/measurement/frame_taker.h"
#include "tod/measurement/set_up_step.h"
#include "tod/plate/test_pattern.h"
#include "tod/presentation/target_failure.h"
#include "tod/registration/patch_windows.h"

namespace todbench {
namespace {

constexpr double focus_factor = 1.3;    ///< the emulated laboratory stays within 1.1
constexpr double tilt_percent = 1;      ///< half of the deviation between scale and plan that the plan allows
constexpr double drift_limit_px = 0.2;  ///< a hundred times the error of the located centre

Polygon plate_corners(const TargetPlate& plate, const Registration& registration) {
  const double x = plate.width_mm / 2, y = plate.height_mm / 2;
  Polygon out;
  for (const cv::Point2d corner : {cv::Point2d(-x, -y), cv::Point2d(x, -y), cv::Point2d(x, y), cv::Point2d(-x, y)})
    out.push_back(registration.pixel(corner));
  return out;
}

/// Largest relative difference of magnification, over the plate and between directions, in percent.
double magnification_spread_percent(const TargetPlate& plate, const Registration& registration) {
  const double x = plate.width_mm / 2, y = plate.height_mm / 2;
  std::vector<double> scales;
  for (const cv::Point2d place : {cv::Point2d(-x, 0), cv::Point2d(x, 0), cv::Point2d(0, -y), cv::Point2d(0, y)})
    scales.push_back(registration.scale_at(place));
  const double along_x = cv::norm(registration.pixel({x, 0}) - registration.pixel({-x, 0})) / (2 * x);
  const double along_y =
      registration.pixel_aspect * cv::norm(registration.pixel({0, y}) - registration.pixel({0, -y})) / (2 * y);
  const auto [low, high] = std::minmax_element(scales.begin(), scales.end());
  return 100 * std::max(*high / *low - 1, std::max(along_x, along_y) / std::min(along_x, along_y) - 1);
}

void add_remarks(Alignment& look, const TargetPlate& plate, const std::vector<int>& sides, cv::Size picture) {
  const Registration& registration = *look.registration;
  if (look.expected_blur_px > 0 && registration.blur_px > focus_factor * look.expected_blur_px) {
    look.remarks.push_back({AlignmentHint::out_of_focus, "Out of focus: the edges have a blur of " +
                                                             fixed(registration.blur_px, 2) + " px, expected " +
                                                             fixed(look.expected_blur_px, 2) + " px"});
  }
  if (const double spread = magnification_spread_percent(plate, registration); spread > tilt_percent) {
    look.remarks.push_back(
        {AlignmentHint::tilted, "Tilted: the magnification differs by " + fixed(spread, 1) + " % over the plate"});
  }
  const auto problems = windows_out_of_picture(plate, registration, sides, picture);
  if (!problems.empty()) {
    look.remarks.push_back({AlignmentHint::near_edge, "Too close to the edge: " + std::to_string(problems.size()) +
                                                          " windows extend beyond the picture, first " +
                                                          problems.front().triangle});
  }
  if (look.drift_px > drift_limit_px) {
    look.remarks.push_back({AlignmentHint::drifting, "Drifting: the plate has moved by " + fixed(look.drift_px, 2) +
                                                         " px since the alignment started"});
  }
}

/// Blur by registration in a noise-free picture of the simulated sensor; 0 if the plate is not found in it.
double expected_blur_px(const ExperimentInputs& inputs, const TargetPlate& plate, const Plan& plan) {
  if (sensor_module(inputs.sensor) != nullptr) return 0;
  const SensorModel model(inputs.sensor, inputs.effects, inputs.accuracy, plan.seed);
  PlateScene scene;
  scene.plate = plate;
  scene.delta_t_k = 1;
  scene.distance_m = plan.target.distance_m;
  RegistrationOptions options = simulated_options(plan, inputs).registration;
  options.expected_scale_px_per_mm =
      1 / (plan.target.distance_m * inputs.sensor.ifov_mrad() / inputs.sensor.samples_per_pitch());
  cv::Mat1d picture;
  model.unit_signal(scene)->convertTo(picture, CV_64F);
  const auto found = register_plate(picture, plate, options);
  return found ? found->blur_px : 0;
}

/// State that is common to all looks.
struct Aligning {
  TargetPlate plate;  ///< as mounted
  std::vector<int> sides;
  RegistrationOptions registration;
  double expected_blur_px = 0;
};

Result<Aligning> prepare(const Plan& plan, const ExperimentInputs& inputs, const MeasurementOptions& options,
                         const TargetState& state) {
  Aligning out;
  const auto plate = std::find_if(inputs.plates.begin(), inputs.plates.end(),
                                  [&](const TargetPlate& p) { return p.name == state.plate; });
  out.plate = mounted(*plate, state.mounting);
  out.registration = options.registration;
  out.registration.expected_scale_px_per_mm = 1 / (plan.target.distance_m * plan.camera.ifov_mrad);
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  for (const auto& t : out.plate.triangles) {
    auto prepared = observer.prepare(t.size_mm * out.registration.expected_scale_px_per_mm, options.samples_per_pitch);
    if (!prepared) return fail("plate " + out.plate.name + ", " + t.name, prepared.error());
    out.sides.push_back((*prepared)->window_samples());
  }
  out.expected_blur_px = expected_blur_px(inputs, out.plate, plan);
  return out;
}

Result<void> look_until_stopped(FrameTaker& taker, const Aligning& aligning, const MeasurementOptions& options,
                                const AlignmentListener& listener, const std::stop_token& stop) {
  std::optional<Registration> first;
  while (!stop.stop_requested()) {
    auto picture = taker.average(options.contrast_frames, stop);
    if (!picture) {
      if (picture.error().code == ErrorCode::interrupted) return {};
      return tl::unexpected(picture.error());
    }
    Alignment look = look_at_plate(picture->kelvin, aligning.plate, aligning.sides, aligning.registration,
                                   aligning.expected_blur_px, first);
    look.temporal_noise_k = picture->temporal_noise_k;
    if (!first) first = look.registration;
    if (listener.on_alignment) listener.on_alignment(look);
  }
  return {};
}

}  // namespace

std::string_view to_string(AlignmentHint hint) {
  switch (hint) {
    case AlignmentHint::not_found:
      return "not_found";
    case AlignmentHint::out_of_focus:
      return "out_of_focus";
    case AlignmentHint::tilted:
      return "tilted";
    case AlignmentHint::near_edge:
      return "near_edge";
    case AlignmentHint::drifting:
      return "drifting";
  }
  return "unknown";
}

Alignment look_at_plate(const cv::Mat1d& kelvin, const TargetPlate& mounted_plate, const std::vector<int>& sides,
                        const RegistrationOptions& options, double expected_blur_px,
                        const std::optional<Registration>& first) {
  Alignment look;
  look.expected_blur_px = expected_blur_px;
  auto registration = register_plate(kelvin, mounted_plate, options);
  if (!registration) {
    look.remarks.push_back({AlignmentHint::not_found, registration.error().message});
    return look;
  }
  look.registration = *registration;
  look.plate_px = plate_corners(mounted_plate, *registration);
  for (std::size_t i = 0; i < mounted_plate.triangles.size(); ++i) {
    const auto& t = mounted_plate.triangles[i];
    AlignedTriangle aligned{.name = t.name, .outline_px = {}, .window = {}};
    for (const auto& corner : triangle(t.size_mm, t.apex, t.position_mm))
      aligned.outline_px.push_back(registration->pixel(corner));
    aligned.window = patch_window(registration->pixel(t.position_mm), sides[i]).pixels;
    look.triangles.push_back(std::move(aligned));
  }
  if (first) look.drift_px = cv::norm(registration->pixel({0, 0}) - first->pixel({0, 0}));
  add_remarks(look, mounted_plate, sides, kelvin.size());
  return look;
}

Result<void> align_plan(const Plan& plan, const AlignmentListener& listener, std::stop_token stop) {
  TODBENCH_TRY(const auto loaded, LoadedPlan::load(plan));
  EffectPlanner planner;
  TODBENCH_TRY(auto inputs, experiment_inputs(loaded, planner));
  if (listener.on_phase) listener.on_phase("opening " + plan.camera.id);
  TODBENCH_TRY(auto bench, open_bench(loaded, stop, {}, listener.on_phase));
  if (listener.on_open) listener.on_open(bench.camera->info());
  if (listener.on_frame) bench.camera = observed_source(std::move(bench.camera), listener.on_frame);
  const auto states = constant_stimuli(stimuli_options(plan, inputs.plates, plan.camera.ifov_mrad, Side::measured),
                                       RandomStream(plan.seed, "schedule"));
  if (states.empty())
    return fail(ErrorCode::invalid_input, "the plan shows no target: it has no plate, mounting or contrast");
  TargetState state = states.front();
  state.shift_mm = {0, 0};
  const MeasurementOptions options = camera_options(plan, inputs.plates);
  auto aligning = prepare(plan, inputs, options, state);
  if (!aligning) return tl::unexpected(aligning.error());
  if (listener.on_phase) listener.on_phase("aligning " + state.plate + " at " + stated(state.delta_t_k) + " K");

  const std::stop_callback wake(stop, [&] { bench.camera->stop(); });
  TODBENCH_TRY_VOID(bench.camera->start());
  auto presented = bench.target->present(state, stop);
  if (!presented) {
    if (presented.error().code == ErrorCode::interrupted) return {};
    return target_failure("presenting the target", presented.error());
  }
  FrameTaker taker(*bench.camera, taker_options(options, bench.camera->info()));
  taker.scene_changed(monotonic_ns());
  auto ended = look_until_stopped(taker, *aligning, options, listener, stop);
  bench.camera->stop();
  return ended;
}

}  // namespace todbench
