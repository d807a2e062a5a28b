// SPDX-License-Identifier: GPL-3.0-or-later
// Target transfer probability functions by name. They convert cycles or values on a target to the probability of a
// task.
#pragma once

#include <string_view>

namespace todbench {

/// Form of P = x^E / (1 + x^E), where x is the number on the target divided by the number for 50 %. A criterion is
/// valid only for its own form. For example, the ranges for 75 % of the last two forms differ by a fifth.
enum class ProbabilityForm {
  johnson,    ///< E = 2.7 + 0.7 x: cycles N / N50 of ACQUIRE
  ttp_2004,   ///< E = 1.51 + 0.24 x: V / V50 of the TTP metric as published in 2004
  fixed_1_5,  ///< E = 1.5: V / V50 in more recent programs
};
/// Returns "johnson", "ttp-2004" or "fixed-1.5".
[[nodiscard]] std::string_view to_string(ProbabilityForm form);

/// Returns P at x >= 0. The limits 0 and 1 are exact.
[[nodiscard]] double target_probability(ProbabilityForm form, double x);
/// Returns the x at which the probability is reached, accurate to a few units in the last place. Precondition: 0 <
/// probability < 1.
[[nodiscard]] double ratio_for_probability(ProbabilityForm form, double probability);

}  // namespace todbench
