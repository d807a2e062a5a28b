// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/devices/stage_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "acquisition/base/try.h"
#include "bench/plan/plan_options.h"
#include "hvs/observer/template_observer.h"
#include "tod/measurement/measurement.h"
#include "tod/plate/test_pattern.h"
#include "tod/presentation/largest_contrast.h"

namespace todbench {
namespace {

constexpr double driven_px = 1;

/// Centre, both sides of each axis, and the centre again.
constexpr std::array<std::array<double, 2>, 6> shifts_px{{{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}, {0, 0}}};

std::vector<TargetState> states_of(const Plan& plan) {
  const double pixel_mm = plan.camera.ifov_mrad * plan.target.distance_m;
  std::vector<TargetState> states;
  for (const auto& [x, y] : shifts_px)
    states.push_back({.plate = plan.target.plates.front(),
                      .mounting = plan.target.mountings.front(),
                      .delta_t_k = largest_contrast_k(plan.target.delta_t_k),
                      .shift_mm = driven_px * pixel_mm * cv::Point2d(x, y * plan.camera.pixel_aspect)});
  return states;
}

std::vector<ShiftSeen> places_of(const std::vector<Presentation>& presentations) {
  std::vector<ShiftSeen> places;
  for (const Presentation& shown : presentations) {
    if (!shown.asked_px || !shown.seen_px || !shown.seen_error_px) continue;
    places.push_back({.presentation = shown.presentation,
                      .asked_px = *shown.asked_px - *presentations.front().asked_px,
                      .off_px = *shown.seen_px - *shown.asked_px,
                      .standard_error_px = {*shown.seen_error_px, *shown.seen_error_px}});
  }
  return places;
}

}  // namespace

Result<StageMovement> check_stage_movement(const LoadedPlan& loaded, const SayProgress& on_progress,
                                           std::stop_token stop) {
  const Plan& plan = loaded.plan();
  TODBENCH_TRY(auto bench, open_bench(loaded, stop, {}, on_progress));
  if (!bench.target->capabilities().sets_shift)
    return fail(ErrorCode::invalid_input,
                "the stage of the plan does not move the plate, so there is no movement to check");
  MeasurementOptions options = camera_options(plan, loaded.plates());
  // Positions are measured here, so none is rejected.
  options.max_shift_error_px = 1000;
  TemplateObserver observer(loaded.observer(), triangle_alternatives());
  const std::vector<TargetState> states = states_of(plan);
  ListedSchedule schedule(states);
  const auto run = measure(*bench.camera, *bench.target, observer, schedule, options, *bench.host, {}, std::move(stop));
  if (!run) return tl::unexpected(run.error());
  if (run->ended_by) return tl::unexpected(*run->ended_by);
  const std::vector<ShiftSeen> places = places_of(run->presentations);
  const auto fit = fit_stage(places);
  if (!fit || places.size() < states.size())
    return fail(ErrorCode::calibration, "the plate could not be located at each position of the stage");
  return StageMovement{.driven_px = driven_px,
                       .fit = *fit,
                       .cause = moves_as_asked(*fit, most_stage_deviation) ? "" : likely_cause(places)};
}

}  // namespace todbench
