// SPDX-License-Identifier: GPL-3.0-or-later
// Prediction of a plan: effects, trials, uncertainty, time.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "bench/forecast/bench_time.h"
#include "bench/plan/plan.h"
#include "bench/session/json_output.h"
#include "bench/twin/experiment_inputs.h"

namespace todbench {

/// Prediction of one contrast.
struct ContrastPrediction {
  double delta_t_k = 0;
  std::optional<double> s75_mrad;  ///< by CuedEstimate; empty: no threshold is expected
  /// Half-width of the 95 % interval of S75 from the trials, binary or graded as planned (graded_precision.h), which 95
  /// % of runs do not exceed. For an adaptive schedule, the requested half-width, or the half-width that its cap
  /// allows. Empty: not identified.
  std::optional<double> uncertainty_percent;
  double trials = 0;  ///< number of trials of the simulation; for an adaptive schedule, the mean of simulated runs
  /// Expected standard error of ln S75, without the margin for unlucky runs that `uncertainty_percent` includes; 0: not
  /// identified.
  double se_ln_s75 = 0;
  /// Half-width of the 95 % interval of ln S75 over its own standard error.
  double interval_factor = 0;
  std::optional<double> degrees_of_freedom{};  ///< degrees of freedom of `se_ln_s75`; empty: infinite
  bool over_set_ups = false;  ///< true: graded answers whose interval comes from the scatter over set-ups
  /// Half-width of ln S75 due to the scatter of the measured contrast alone; more presentations do not reduce it. It is
  /// part of `uncertainty_percent`.
  double contrast_half_width = 0;
  /// Half-width at which an adaptive schedule stops, in percent; empty for a different schedule, or if less than half
  /// of the simulated runs stop before its cap.
  std::optional<double> stopped_at_percent{};
  /// Standard error of the ln ratio of camera and twin if both are measured at common phases, with the same margin as
  /// `uncertainty_percent`; empty: the plan contains no paired comparison.
  std::optional<double> paired_se_ln_ratio{};
};

struct PlanPrediction {
  PlanFigures figures;  ///< uncertainty: the largest over the contrasts; without times
  std::vector<ContrastPrediction> contrasts;
  std::vector<AdaptiveRun> runs{};    ///< simulated runs of an adaptive schedule (adaptive_forecast.h)
  std::vector<std::string> warnings;  ///< one sentence each
};

/// Returns the plan with all numbers of frames per presentation. If the plan does not state a number and uses graded
/// answers, the number becomes the smallest of 1, 2, 4 and 8 whose variance (graded_precision.h) times the time of a
/// presentation (bench_time()) is within 10 % of the minimum; the number is 4 if no time or threshold is predicted.
/// Binary answers use one frame.
[[nodiscard]] Plan with_frames(Plan plan, const ExperimentInputs& inputs);

/// Predicts a plan in two milliseconds (an adaptive schedule in less than a tenth of a second), without simulation or
/// reading of files. `inputs`: inputs of the plan
/// (experiment_inputs()). Errors: `invalid_input` (the tolerance cannot be met within the hard caps; the message states
/// the possible tolerance and its time). A contrast without a threshold has no uncertainty, and the plan then has no
/// uncertainty either; a warning names the contrast.
[[nodiscard]] Result<PlanPrediction> predict_plan(const Plan& plan, const ExperimentInputs& inputs);

/// Returns the plan with the camera's number of phases also for the simulation, if the plan has a camera.
/// predict_plan() then predicts the curve of the camera.
[[nodiscard]] Plan as_measured(Plan plan);

/// Adds the times to a prediction of the same plan: predict_time() (bench/forecast/time_prediction.h) and
/// expected_bench_time() for the curve of the camera. If the times cannot be predicted, they stay empty. Errors: those
/// of predict_time() and predict_plan().
[[nodiscard]] Result<void> predict_times(const Plan& plan, const ExperimentInputs& inputs, PlanPrediction& prediction,
                                         std::stop_token stop);

/// Returns the number of triangles of all plates.
[[nodiscard]] double triangles_of(const std::vector<TargetPlate>& plates);

/// Returns the bench time of a plan whose camera has this prediction; the mean of its runs for an adaptive schedule.
[[nodiscard]] BenchTime expected_bench_time(const Plan& plan, const ExperimentInputs& inputs,
                                            const PlanPrediction& prediction);

}  // namespace todbench
