// SPDX-License-Identifier: GPL-3.0-or-later
// Decision rules by name. The plan states its rule before the measurement.
#pragma once

#include <array>
#include <string_view>

namespace todbench {

/// Decision rules of ILAC-G8:09/2019, 4.2. Agree on the rule before the measurement (ISO/IEC 17025, 7.1.3).
enum class ConformityRule {
  guarded_acceptance_and_rejection,  ///< pass if inside the limit by the guard band, fail if outside by the guard
                                     ///< band, else inconclusive
  simple,                            ///< 4.2.1: pass inside the tolerance, else fail; risk up to 50 % at the limit
  guarded,                           ///< 4.2.2: pass if inside the limit by the guard band, else fail
  non_binary,                        ///< 4.2.3: within the guard band: conditional pass or conditional fail
};
inline constexpr std::array conformity_rules{ConformityRule::guarded_acceptance_and_rejection, ConformityRule::simple,
                                             ConformityRule::guarded, ConformityRule::non_binary};
/// Returns the name of the enumerator.
[[nodiscard]] std::string_view to_string(ConformityRule rule);

}  // namespace todbench
