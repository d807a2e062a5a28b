// SPDX-License-Identifier: GPL-3.0-or-later
// Bench time against the probability that a limit on acuity is decided.
#pragma once

#include <optional>

#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/forecast/prediction.h"
#include "bench/judgement/acuity_uncertainty.h"
#include "bench/plan/joined_uncertainty.h"
#include "bench/plan/plan.h"
#include "bench/twin/experiment_inputs.h"

namespace todbench {

/// Uncertainty of ln acuity that a measurement will state.
struct ExpectedUncertainty {
  double se = 0;               ///< standard error from the finite trials
  double interval_factor = 0;  ///< half-width of the 95 % interval of the trials, divided by `se`
  std::optional<double> degrees_of_freedom{};
  JoinedUncertainty stated{};  ///< rows of the budget that the trials do not reduce
};

/// Returns the contrast if it is expected to have a threshold; null otherwise.
[[nodiscard]] const ContrastPrediction* expected_at(const PlanPrediction& prediction, double delta_t_k);

/// Returns the uncertainty that a prediction expects at a contrast, with the rows of `budget` (null: no budget); empty
/// without a threshold.
[[nodiscard]] std::optional<ExpectedUncertainty> expected_uncertainty(const ContrastPrediction& contrast,
                                                                      const CurveUncertainty* budget);

/// Probabilities of the three decisions; their sum is 1.
struct DecisionChances {
  double pass = 0, fail = 0, inconclusive = 0;
};

/// Returns the probabilities of the decisions for a camera whose ln acuity exceeds the limit's ln acuity by
/// `ln_over_limit`. The estimate is normal with the standard error of the trials joined with the stated rows. The
/// stated standard error of the trials scatters as chi over its degrees of freedom. The interval is computed as in
/// judge(): the larger of the statistical half-width and the half-width of all rows. Without stated rows, the
/// probability of a pass follows from a noncentral t distribution. Integrated over 200 quantiles of the chi-square
/// distribution: errors below 0.001. A conditional decision counts as inconclusive. Precondition: se > 0,
/// interval_factor > 0.
[[nodiscard]] DecisionChances decision_chances(double ln_over_limit, const ExpectedUncertainty& expected,
                                               const LimitsPlan& limits);

/// Returns the half-width of the trials, in ln acuity, below which the deciding interval shrinks by less than 5 %: 0.32
/// times the half-width of the stated rows. 0 without rows, because every presentation then reduces the interval.
[[nodiscard]] double smallest_half_width_ln(const JoinedUncertainty& stated);

/// Decisions for a camera of a given acuity.
struct CameraChance {
  double over_limit_percent = 0;  ///< excess of the camera's acuity over the limit, in percent of the limit
  DecisionChances chances;
};

/// A variant of the plan: with a different number of frames or phases, a different rate of its ramp, or a different
/// half-width of its adaptive schedule.
struct DecisionDesign {
  std::vector<int> frames{};             ///< frames per presentation: one number for all contrasts, or one for each
  int phases = 0;                        ///< phases per set-up and contrast
  int contrast_frames = 0;               ///< frames of the measured contrast
  std::optional<double> ramp_k_per_s{};  ///< rate of a ramp, which has no phases
  /// Half-width at which an adaptive schedule ends, in percent.
  std::optional<double> asked_percent{};
  double bench_s = 0;                   ///< bench time of the whole plan (laboratory_time())
  double half_width_percent = 0;        ///< expected half-width of the trials at the contrast of the limit
  double deciding_percent = 0;          ///< expected half-width including the stated rows
  bool planned = false;                 ///< true for the plan itself
  std::vector<CameraChance> cameras{};  ///< cameras from 10 % below to 10 % above the limit, in steps of 1 %
  /// Probabilities for a unit of the fleet, if the plan states the fleet: accepted although it is below the limit
  /// (consumer), and not accepted although it is above the limit (producer).
  std::optional<double> consumer_risk{}, producer_risk{};
};

/// Row of the budget that the trials do not reduce.
struct FloorRow {
  std::string name;
  double half_width_percent = 0;  ///< 1.96 standard uncertainties of ln acuity
};

/// Forecast of the decision on one limit.
struct DecisionForecast {
  double delta_t_k = 0;
  double least_acuity_per_mrad = 0;
  /// Excess of the simulated sensor's acuity over the limit, in percent of the limit.
  double expected_over_limit_percent = 0;
  double floor_percent = 0;                ///< half-width of all stated rows; 0: no budget
  double smallest_half_width_percent = 0;  ///< smallest_half_width_ln()
  std::vector<FloorRow> rows{};            ///< the stated rows, the largest half-width first
  /// Half-width due to the scatter of the measured contrast, as planned. More presentations do not reduce it.
  double contrast_percent = 0;
  /// Frames of the measured contrast from deciding_contrast_frames(); empty if the number of the plan need not change.
  std::optional<int> contrast_frames{};
  std::vector<DecisionDesign> designs{};   ///< by bench time
  std::optional<double> enough_bench_s{};  ///< least bench time of a design whose half-width is at most
                                           ///< smallest_half_width_percent
};

/// Returns the bench time in s. For a simulated scene, the change times of the plan are used, as if it ran on a bench.
[[nodiscard]] double laboratory_time(Plan plan, const ExperimentInputs& inputs, const std::vector<AdaptiveRun>& runs);

/// Forecasts every limit on acuity whose contrast has a threshold, for the plan and for its variants. Variants of an
/// adaptive schedule have a quarter to four times the half-width. Variants of a ramp have a quarter to four times the
/// rate, at most the rate that a stated lag of the plate allows. Other variants have 1 to 64 frames with graded
/// answers, or a quarter to four times the phases with binary answers. If the measured contrast prevents a decision,
/// the same variants follow with deciding_contrast_frames(). Errors: those of predict_plan() and curve_uncertainty().
[[nodiscard]] Result<std::vector<DecisionForecast>> decision_forecasts(const Plan& plan,
                                                                       const ExperimentInputs& inputs);

/// Returns the half-width of all stated rows at each contrast of the prediction, in ln acuity; zeros without a budget.
/// Errors: those of curve_uncertainty().
[[nodiscard]] Result<std::vector<double>> floors_ln(const Plan& plan, const PlanPrediction& prediction);

/// Returns a text about the limits that cannot be decided because of the stated rows of the budget: even without
/// scatter of the trials, the probability of a decision on the limit is below `probability`. States the distance of the
/// predicted acuity from each of these limits. Empty: all limits can be decided.
[[nodiscard]] std::string open_by_budget(const Plan& plan, const std::vector<ContrastPrediction>& contrasts,
                                         const CurveUncertainty* budget, double probability);

/// Returns "0.23 K, at least 0.2 1/mrad: ..."
[[nodiscard]] std::string in_words(const DecisionForecast& forecast);

}  // namespace todbench
