// SPDX-License-Identifier: GPL-3.0-or-later
// Designs of least bench time, asked against achieved, and forecast decisions against those of whole simulated runs.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "bench/forecast/decision_forecast.h"
#include "bench/forecast/design_search.h"
#include "bench/judgement/limit_decision.h"
#include "tests/bench/studies/graded_runs.h"

namespace todbench::testing {

/// A bench with its change times and an asked half-width.
struct TimedBench {
  std::string name;
  double plate_s = 60, mounting_s = 30, contrast_s = 20, shift_s = 0.1;
  double asked_percent = 2.5;
  GradedDesign design{};
};

inline TimedBench default_bench() {
  return {.name = "default", .design = default_design()};
}

/// The same camera before a black body that settles slowly, on a quick stage.
inline TimedBench slow_black_body() {
  return {.name = "slow black body",
          .plate_s = 20,
          .mounting_s = 10,
          .contrast_s = 90,
          .asked_percent = 3,
          .design = default_design()};
}

/// An uncooled camera of 17 um with a stage that changes quickly.
inline TimedBench quick_stage() {
  TimedBench bench{.name = "quick stage", .plate_s = 5, .mounting_s = 5, .contrast_s = 10, .asked_percent = 4};
  SensorSpec& sensor = bench.design.camera;
  sensor.pitch_um = 17;
  sensor.detector_um = 15.3;
  sensor.focal_length_mm = 25;
  sensor.netd_k = 0.05;
  bench.design.twin = sensor;
  bench.design.delta_t_k = {10, 1, 0.2};
  bench.design.distance_m = 2.6 / sensor.ifov_mrad();
  return bench;
}

/// The plan of a bench as it is, with a simulated camera.
inline Plan plan_as_it_was(const TimedBench& bench) {
  Plan plan = plan_of(bench.design, 1);
  plan.schedule.frames_per_presentation = {0};
  plan.target.plate_change_s = bench.plate_s;
  plan.target.mounting_change_s = bench.mounting_s;
  plan.target.contrast_change_s = bench.contrast_s;
  plan.target.shift_change_s = bench.shift_s;
  plan.simulation.phases = plan.target.phases = TargetPlan{}.phases;
  return plan;
}

/// The design that the search finds for a bench; its half-width is the asked one.
inline Result<BestDesign> design_of_bench(const TimedBench& bench) {
  const Plan plan = plan_as_it_was(bench);
  PlanParts parts = LoadedPlan::load(plan).value().parts();
  parts.sensor = bench.design.twin;
  EffectPlanner planner;
  const auto inputs = experiment_inputs(LoadedPlan::of(plan, std::move(parts)).value(), planner);
  if (!inputs) return tl::unexpected(inputs.error());
  return best_design(plan, *inputs, {.half_width_percent = bench.asked_percent}, {});
}

/// One contrast of one run.
struct DesignedRun {
  double delta_t_k = 0;
  double s75_mrad = 0, low_mrad = 0, high_mrad = 0, degrees_of_freedom = 0;
  [[nodiscard]] double half_width_percent() const { return 50 * std::log(high_mrad / low_mrad); }
};

/// A whole simulated run of a plan.
inline std::vector<DesignedRun> run_of_design(Plan plan, std::uint64_t seed, DesignParts& parts) {
  plan.seed = seed;
  const ExperimentInputs camera = inputs_of(plan, parts.design().camera), twin = inputs_of(plan, parts.design().twin);
  const std::vector<Trial> trials = trials_of(plan, camera, parts);
  std::vector<DesignedRun> runs;
  auto curve = tod_curve(trials, {.with_posterior = false});
  EXPECT_TRUE(curve) << seed;
  if (!curve) return runs;
  give_functions(*curve, trials, twin, seed, parts);
  for (const TodPoint& point : curve->points) {
    EXPECT_TRUE(point.fit.usable()) << seed;
    if (!point.fit.usable()) continue;
    runs.push_back(
        {point.set_delta_t_k, *point.fit.threshold, *point.fit.ci95.low, *point.fit.ci95.high, point.fit.clusters - 1});
  }
  return runs;
}

/// Runs of one contrast.
struct DesignSummary {
  double runs = 0, ratio = 0, kept = 0;  ///< achieved over asked half-width, mean; share not above it
  double coverage = 0, bias_percent = 0, scatter_percent = 0;
};

inline DesignSummary summary_of_design(const std::vector<DesignedRun>& rows, double delta_t_k, double asked_percent,
                                       double truth_mrad) {
  DesignSummary out;
  const double asked = 100 * std::log1p(asked_percent / 100);
  double squares = 0;
  for (const DesignedRun& row : rows) {
    if (row.delta_t_k != delta_t_k) continue;
    ++out.runs;
    const double error = 100 * std::log(row.s75_mrad / truth_mrad);
    out.ratio += row.half_width_percent() / asked;
    out.kept += row.half_width_percent() <= asked ? 1 : 0;
    out.coverage += row.low_mrad <= truth_mrad && truth_mrad <= row.high_mrad ? 1 : 0;
    out.bias_percent += error;
    squares += error * error;
  }
  for (double* mean : {&out.ratio, &out.kept, &out.coverage, &out.bias_percent}) *mean /= out.runs;
  out.scatter_percent = std::sqrt(squares / out.runs - out.bias_percent * out.bias_percent);
  return out;
}

/// Shares of the decisions on a limit that the camera exceeds by this much.
inline DecisionChances decisions_of_runs(const std::vector<DesignedRun>& rows, double delta_t_k, double truth_mrad,
                                         double over_limit_percent) {
  DecisionChances shares;
  double runs = 0;
  for (const DesignedRun& row : rows) {
    if (row.delta_t_k != delta_t_k) continue;
    ++runs;
    const LimitAnswer answer = decide({.value = row.s75_mrad,
                                       .interval = {row.low_mrad, row.high_mrad},
                                       .limit = truth_mrad * (1 + over_limit_percent / 100),
                                       .at_least = false,
                                       .scale = LimitScale::logarithmic,
                                       .degrees_of_freedom = row.degrees_of_freedom},
                                      LimitsPlan{}.rule, std::nullopt);
    shares.pass += answer.decision == ConformityDecision::pass ? 1 : 0;
    shares.fail += answer.decision == ConformityDecision::fail ? 1 : 0;
  }
  shares.pass /= runs;
  shares.fail /= runs;
  shares.inconclusive = 1 - shares.pass - shares.fail;
  return shares;
}

}  // namespace todbench::testing
