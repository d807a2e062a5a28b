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
  /// Half the 95 % interval of S75 from the trials, which 19 of 20 runs do not exceed; of an adaptive schedule what is
  /// asked of it, or what its cap allows. Nothing: not identified.
  std::optional<double> uncertainty_percent;
  double trials = 0;  ///< of the simulation at this contrast
};

struct PlanPrediction {
  EffectPlan effects;
  PlanFigures figures;  ///< uncertainty: the largest over the contrasts; no times
  std::vector<ContrastPrediction> contrasts;
  std::vector<std::string> warnings;  ///< a sentence each
};

/// Nothing is simulated; a tenth of a second, and two milliseconds where `planner` knows the scene: plans that
/// differ in tolerance, trials, schedule and the like. Without a planner, one of its own. Errors: as read_inputs() for
/// what a plan names, `invalid_input` where the tolerance cannot be met within the hard caps (the message says what can
/// and for what time). Contrasts without threshold have no uncertainty, and then the plan has none; a warning names
/// them.
[[nodiscard]] Result<PlanPrediction> predict_plan(const Plan& plan, EffectPlanner& planner);
[[nodiscard]] Result<PlanPrediction> predict_plan(const Plan& plan);

/// Adds the times to a prediction of the same plan, as predict_time() (bench/run/time_prediction.h); a plan whose times
/// cannot be predicted keeps none.
[[nodiscard]] Result<void> predict_times(const Plan& plan, PlanPrediction& prediction, EffectPlanner& planner,
                                         std::stop_token stop);
[[nodiscard]] Result<void> predict_times(const Plan& plan, PlanPrediction& prediction, std::stop_token stop);

}  // namespace todbench
