// The functions of the twin, made while the camera measures.
#pragma once

#include <map>
#include <stop_token>

#include "bench/run/experiment_inputs.h"
#include "bench/run/meanwhile.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Functions that were made beforehand, as the argument `known` of fit_twin_shapes(): those of the contrasts of `curve`
/// that were seen within 2 % of what was set.
[[nodiscard]] TodCurve known_functions(const std::map<double, ProportionTable>& tables, const TodCurve& curve);

/// A camera waits for its target and its frames, and leaves the processor time for 4000 draws per size and contrast.
/// What is fitted is a stretch of the function, so that one at the set contrast is as good as one at the contrast that
/// was seen a little beside it.
class FunctionsMeanwhile {
 public:
  /// Begins on a thread of its own; `plan` and `inputs` outlive it.
  FunctionsMeanwhile(const Plan& plan, const ExperimentInputs& inputs);

  /// Waits, until stopped. known_functions() of them.
  [[nodiscard]] TodCurve known_for(const TodCurve& curve, std::stop_token stop);

 private:
  Meanwhile<Result<std::map<double, ProportionTable>>> made_;
};

}  // namespace todbench
