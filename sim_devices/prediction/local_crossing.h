// SPDX-License-Identifier: GPL-3.0-or-later
// Size with 75 % correct, from proportions correct at a few sizes.
#pragma once

#include <optional>
#include <vector>

#include "sim_devices/prediction/size_trial.h"

namespace todbench {

/// Point in ln size at which the local quadratic in ln((P - 0.25) / (1 - P)) equals ln 2. This transform of the
/// proportion correct P is nearly straight in ln size.
struct Crossing {
  double x = 0, standard_error = 0;  ///< position of the crossing and its standard error, in ln size
};

/// Finds the crossing. `xs`: ln size, increasing in equal steps, at least four, around the crossing; `ps`: proportion
/// correct at each size. A size at a distance of d steps from the crossing has the weight max(0.001, 1 - (d / 3)^2).
/// Crossing and weights are found by iteration, so the result hardly depends on the choice of sizes. The standard error
/// propagates the variances between draws through the fit and its weights. Empty if the proportion does not rise
/// through 75 %.
[[nodiscard]] std::optional<Crossing> local_crossing(const std::vector<double>& xs, const std::vector<Proportion>& ps);

}  // namespace todbench
