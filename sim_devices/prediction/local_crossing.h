// SPDX-License-Identifier: GPL-3.0-or-later
// Size with 75 % correct, from proportions correct at a few sizes.
#pragma once

#include <optional>
#include <vector>

#include "sim_devices/prediction/size_trial.h"

namespace todbench {

/// Point at which the local quadratic in ln((P - 0.25) / (1 - P)), which is nearly straight in ln size, equals ln 2.
struct Crossing {
  double x = 0, standard_error = 0;  ///< in ln size, like `xs`
};

/// `xs`: ln size, increasing in equal steps; at least four, about the crossing. Sizes have the weight 1 - (d / 3)^2, d
/// steps from the crossing, which is found by iteration: the choice of sizes does not move it. The standard error
/// propagates the variances between draws through the fit and its weights. Empty if the proportion does not rise
/// through 75 % there.
[[nodiscard]] std::optional<Crossing> local_crossing(const std::vector<double>& xs, const std::vector<Proportion>& ps);

}  // namespace todbench
