// What a plan will do, before it does it: effects, trials, uncertainty, time.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "bench/plan/plan.h"
#include "bench/run/experiment_inputs.h"
#include "bench/session/json_output.h"

namespace todbench {

/// One contrast of a plan before it is measured.
struct ContrastPrediction {
  double delta_t_k = 0;
  std::optional<double> s75_mrad;  ///< of the first tier; nothing: no threshold is expected
  /// Half the 95 % interval of S75 from the trials, right and wrong or graded as the plan has them
  /// (graded_precision.h), which 19 of 20 runs do not exceed; of an adaptive schedule what is
  /// asked of it, or what its cap allows. Nothing: not identified.
  std::optional<double> uncertainty_percent;
  double trials = 0;  ///< of the simulation at this contrast
};

struct PlanPrediction {
  PlanFigures figures;  ///< uncertainty: the largest over the contrasts; no times
  std::vector<ContrastPrediction> contrasts;
  std::vector<std::string> warnings;  ///< a sentence each
};

/// The plan with every number of frames per presentation: where it leaves one open and graded answers are taken, the
/// fewest of 1, 2, 4 and 8 whose variance (graded_precision.h) times the time of a presentation (bench_time()) is
/// within 10 % of the least of them; four where no time or no threshold is predicted, and one of right and wrong
/// answers.
[[nodiscard]] Plan with_frames(Plan plan, const ExperimentInputs& inputs);

/// Nothing is simulated and nothing read; two milliseconds. `inputs` are those of the plan (experiment_inputs()).
/// `invalid_input` where the tolerance cannot be met within the hard caps (the message says what can and for what
/// time). Contrasts without threshold have no uncertainty, and then the plan has none; a warning names them.
[[nodiscard]] Result<PlanPrediction> predict_plan(const Plan& plan, const ExperimentInputs& inputs);

/// Adds the times to a prediction of the same plan: predict_time() (bench/run/time_prediction.h) and bench_time()
/// (bench/run/bench_time.h). A plan whose times cannot be predicted keeps none.
[[nodiscard]] Result<void> predict_times(const Plan& plan, const ExperimentInputs& inputs, PlanPrediction& prediction,
                                         std::stop_token stop);

/// Presentations to be expected of an adaptive schedule; nothing of the other, which shows its list.
[[nodiscard]] std::optional<double> expected_presentations(const Plan& plan, const std::vector<TargetPlate>& plates,
                                                           const std::vector<ContrastPrediction>& contrasts);

}  // namespace todbench
