// SPDX-License-Identifier: GPL-3.0-or-later
// Runs of whole plans over seeds: what was asked or predicted, and what came out.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/forecast/prediction.h"
#include "bench/run/experiment.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "tests/support/temporary_folder.h"
#include "tod/plate/test_pattern.h"

namespace todbench::testing {

/// One contrast of one run. Percentages are 100 ln of the ratio.
struct AskedAndAchieved {
  double delta_t_k = 0;
  double predicted_percent = 0;  ///< by the plan, before the run
  double achieved_percent = 0;   ///< half of the 95 % interval; 1000 where a side is open
};

/// One run: its curve, and every contrast of it.
struct StudiedRun {
  TodCurve curve;
  std::vector<AskedAndAchieved> contrasts;
};

/// Both plates in all mountings, so often that a constant design has 128 presentations; the simulated SC2000.
inline Plan plan_to_study(ScheduleKind kind, double half_width_percent,
                          EstimatorChoice estimator = EstimatorChoice::automatic) {
  Plan plan;
  plan.name = "asked";
  plan.target.delta_t_k = {1.93, 0.23};
  plan.simulation.accuracy = "draft";
  plan.simulation.phases = 8;
  plan.schedule.kind = kind;
  plan.schedule.half_width_percent = half_width_percent;
  plan.fit.estimator = estimator;
  return plan;
}

inline StudiedRun run_of(Plan plan, std::uint64_t seed, double noise_correlation = 0) {
  plan.seed = seed;
  PlanParts parts = LoadedPlan::load(plan).value().parts();
  parts.sensor.noise_correlation = noise_correlation;
  const LoadedPlan loaded = LoadedPlan::of(plan, parts).value();
  EffectPlanner planner;
  const auto prediction = predict_plan(plan, experiment_inputs(loaded, planner).value());
  const TemporaryFolder folder;
  const auto outcome = simulate_plan(loaded, {.folder = folder.path() / "s"}, {}, {});
  StudiedRun found;
  if (!prediction || !outcome) {
    ADD_FAILURE() << (prediction ? outcome.error().message : prediction.error().message);
    return found;
  }
  for (const TodPoint& point : outcome->curve.points) {
    AskedAndAchieved one{.delta_t_k = point.set_delta_t_k, .achieved_percent = 1000};
    for (const ContrastPrediction& c : prediction->contrasts) {
      if (c.delta_t_k == point.set_delta_t_k)
        one.predicted_percent = 100 * std::log1p(c.uncertainty_percent.value_or(0) / 100);
    }
    const Interval& ci = point.fit.ci95;
    if (ci.low && ci.high) one.achieved_percent = 100 * std::log(*ci.high / *ci.low) / 2;
    found.contrasts.push_back(one);
  }
  found.curve = outcome->curve;
  return found;
}

/// From 20000 draws: standard error 0.07 to 0.2 %.
inline double true_s75_pitch(const SensorSpec& sensor, const SensorPlan& plan, TemplateObserver& observer,
                             double delta_t_k) {
  double sum = 0;
  constexpr std::uint64_t parts = 5;
  for (std::uint64_t part = 0; part < parts; ++part) {
    const auto found = direct_estimate(sensor, plan, observer, {delta_t_k},
                                       {.accuracy = Accuracy::reference(), .seed = 1000000 + part});
    sum += found.value()[0].s75_pitch;
  }
  return sum / parts;
}

struct DirectErrors {
  double rms_percent = 0, stated_percent = 0;  ///< stated: mean of 1.96 standard errors
  double share = 0;                            ///< within the tolerance
};
inline DirectErrors errors_of_direct_estimates(const SensorSpec& sensor, const SensorPlan& plan,
                                               TemplateObserver& observer, double delta_t_k, double tolerance_percent,
                                               double truth_pitch, std::uint64_t seeds) {
  DirectErrors out;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const auto found = direct_estimate(sensor, plan, observer, {delta_t_k},
                                       {.accuracy = Accuracy::for_tolerance(tolerance_percent), .seed = seed});
    if (!found) {
      ADD_FAILURE() << found.error().message;
      return out;
    }
    const DirectPoint& point = found->front();
    const double error = 100 * (truth_pitch / point.s75_pitch - 1);  // of the acuity
    out.rms_percent += error * error;
    out.stated_percent += 196 * point.standard_error_pitch / point.s75_pitch;
    out.share += std::abs(error) <= tolerance_percent ? 1 : 0;
  }
  const auto n = static_cast<double>(seeds);
  return {std::sqrt(out.rms_percent / n), out.stated_percent / n, out.share / n};
}

}  // namespace todbench::testing
