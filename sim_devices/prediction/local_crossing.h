// Where a proportion correct, known at a few sizes, is 75 %.
#pragma once

#include <optional>
#include <vector>

#include "sim_devices/prediction/size_trial.h"

namespace todbench {

/// Where the local quadratic in ln((P - 0.25) / (1 - P)), which is nearly straight in ln size, meets ln 2.
struct Crossing {
  double x = 0, standard_error = 0;  ///< in ln size, as the sizes are given
};

/// `xs`: ln size, rising in equal steps; four or more, about the crossing. Sizes count by 1 - (d / 3)^2, d steps from
/// the crossing, which is found by iteration: which sizes are at hand does not move it. The standard error is that of
/// the variances between draws, by how the fit follows them and how the crossing follows the middle of the fit. Nothing
/// where the proportion does not rise through 75 % there.
[[nodiscard]] std::optional<Crossing> local_crossing(const std::vector<double>& xs, const std::vector<Proportion>& ps);

}  // namespace todbench
