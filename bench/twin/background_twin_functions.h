// SPDX-License-Identifier: GPL-3.0-or-later
// Computation of the functions of the twin while the camera measures.
#pragma once

#include <map>
#include <stop_token>

#include "bench/twin/background_task.h"
#include "bench/twin/experiment_inputs.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Returns precomputed functions as the argument `known` of fit_twin_shapes(): the functions at those contrasts of
/// `curve` whose effective contrast is within 2 % of the set contrast.
[[nodiscard]] TodCurve known_functions(const std::map<double, ProportionTable>& tables, const TodCurve& curve);

/// Computation of the functions with 4000 draws per size and contrast. Uses the processor time that is free while the
/// camera waits for its target and frames. The fit only stretches a function, so the function at the set contrast
/// can also be used for a slightly different effective contrast.
class BackgroundTwinFunctions {
 public:
  /// Starts on its own thread; `plan` and `inputs` must outlive this object.
  BackgroundTwinFunctions(const Plan& plan, const ExperimentInputs& inputs);

  /// Waits for the functions or a stop, and returns known_functions().
  [[nodiscard]] TodCurve known_for(const TodCurve& curve, std::stop_token stop);

 private:
  BackgroundTask<Result<std::map<double, ProportionTable>>> made_;
};

}  // namespace todbench
