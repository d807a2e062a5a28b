// SPDX-License-Identifier: GPL-3.0-or-later
// Predicted cost and uncertainty of a plan.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "bench/forecast/prediction.h"
#include "bench/plan/loaded_plan.h"
#include "bench/report/accuracy_bill.h"
#include "bench/report/plot.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Expected S75 of the simulated sensor of a plan at a contrast.
struct ExpectedThreshold {
  double delta_t_k = 0;
  std::optional<double> s75_mrad;  ///< empty: no size has a threshold at this contrast
  bool operator==(const ExpectedThreshold&) const = default;
};

/// Refines the thresholds of `inputs` by direct estimates, as `todbench plan` does. Takes a few seconds. Errors:
/// `interrupted`.
[[nodiscard]] Result<std::vector<ExpectedThreshold>> expected_thresholds(const Plan& plan, ExperimentInputs inputs,
                                                                         std::stop_token stop);
/// Returns the thresholds as a curve without intervals.
[[nodiscard]] TodCurve as_curve(const std::vector<ExpectedThreshold>& expected);

/// Results of predict_plan() and predict_times(), which take a few tenths of a second.
struct PlanForecast {
  Plan plan;                             ///< the predicted plan
  std::vector<int> frames;               ///< frames per presentation by with_frames(), if the plan does not state them
  SensorPlan effects;                    ///< decisions of the planner with their reasons
  std::vector<std::string> warnings;     ///< one sentence each
  std::vector<ContrastPrediction> twin;  ///< prediction with the phases of the simulation; empty: see `problem`
  std::vector<ContrastPrediction> camera;  ///< prediction with the phases of the target
  std::vector<AdaptiveRun> runs{};         ///< simulated runs of an adaptive schedule with the camera
  /// Largest half-width of the camera with 1, 2, 4 and 8 frames per presentation; empty for binary answers.
  std::vector<std::pair<int, double>> by_frames;
  std::optional<double> twin_s;        ///< time of the simulation on one core
  std::optional<AccuracyBill> bill{};  ///< bill_forecast(); empty: no camera, a simulated scene, or `problem`
  std::string problem;                 ///< reason why the tolerance cannot be met; empty: it can be met
};

/// Computes the predictions. `known`: thresholds that replace the estimates of the planner; may be empty. `planner`
/// caches decisions that do not depend on tolerance and trials. Errors: `interrupted`.
[[nodiscard]] Result<PlanForecast> forecast(const LoadedPlan& loaded, const std::vector<ExpectedThreshold>& known,
                                            EffectPlanner& planner, std::stop_token stop = {});

/// Prediction at one contrast.
struct PlannedContrast {
  double delta_t_k = 0;
  std::optional<double> s75_mrad;  ///< S75 by CuedEstimate, or by expected_thresholds()
  std::optional<double> camera_uncertainty_percent, twin_uncertainty_percent;  ///< half of the 95 % interval of S75
};

/// Counts, time and uncertainties of a plan.
struct PlanPreview {
  std::uint64_t presentations = 0, trials = 0;  ///< numbers for the camera; expected numbers for an adaptive schedule
  double bench_s = 0;                           ///< bench time by bench_time() (bench/forecast/bench_time.h)
  std::optional<double> twin_s;
  std::vector<PlannedContrast> contrasts;
  std::vector<std::pair<double, double>> by_frames;  ///< bench time and uncertainty of PlanForecast::by_frames
  /// Returns the largest uncertainty of the camera over the contrasts; empty if a contrast has no threshold.
  [[nodiscard]] std::optional<double> uncertainty_percent() const;
};

/// Computes the preview, fast enough to follow a slider. If the plan and the forecast have different numbers of phases,
/// ln(1 + uncertainty) is scaled with the square root of forecast phases / plan phases, except for an adaptive
/// schedule. The time of the simulation is scaled with plan phases / forecast phases. If `seen` is null, only counts
/// and bench time are computed.
[[nodiscard]] PlanPreview outlook(const Plan& plan, const std::vector<TargetPlate>& plates, const PlanForecast* seen,
                                  double frame_rate_hz);

/// Returns the plan with a different tolerance. Sets the phases of camera and twin to the smallest number (2 to 256)
/// with which the camera reaches the tolerance at every contrast with a threshold. If no number suffices, sets them to
/// 256. For an adaptive schedule, sets the requested half-width instead. If `seen` is null, the phases do not change.
[[nodiscard]] Plan with_tolerance(Plan plan, const PlanForecast* seen, double tolerance_percent);

/// One point of the frontier: the cost of an accuracy.
struct AccuracyPrice {
  double tolerance_percent = 0;
  int phases = 0;
  double bench_s = 0;
  std::optional<double> twin_s;  ///< empty: the simulation cannot reach the accuracy
};

/// Runs predict_plan() and predict_times() for tolerances from 0.5 to 20 %. Omits tolerances that 256 phases do not
/// reach. If stop is requested, returns the points that are already computed. The result does not depend on the
/// tolerance and the phases of the plan. `known`: as for forecast().
[[nodiscard]] std::vector<AccuracyPrice> accuracy_prices(const LoadedPlan& loaded, const PlanForecast& seen,
                                                         const std::vector<ExpectedThreshold>& known,
                                                         double frame_rate_hz, EffectPlanner& planner,
                                                         const std::stop_token& stop);

/// Returns the plot of uncertainty against bench time and time of the simulation. Further points show the
/// presentations of the plan with 1, 2, 4 and 8 frames each. A square marks the plan itself.
[[nodiscard]] Plot accuracy_plot(const std::vector<AccuracyPrice>& prices, const PlanPreview& now);

}  // namespace todbench
