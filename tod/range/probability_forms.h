// SPDX-License-Identifier: GPL-3.0-or-later
// Target transfer probability functions by name. These functions give the probability that an observer performs a task
// on a target. The argument is the number of cycles N, or the value V of the TTP metric, on the target.
#pragma once

#include <string_view>

namespace todbench {

/// Form of the probability P = x^E / (1 + x^E), in which x is N / N50 or V / V50. N50 or V50 is the criterion: the
/// number of cycles or the value at which P is 50 %. Use a criterion only with the form with which it was determined.
/// For example, with the same V50, the ranges for P = 75 % differ by a fifth between the last two forms.
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
