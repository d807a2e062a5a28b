// Decision rules by name, which a plan agrees on before the measurement.
#pragma once

#include <array>
#include <string_view>

namespace todbench {

/// ILAC-G8:09/2019, 4.2. To be agreed before the measurement (ISO/IEC 17025, 7.1.3).
enum class ConformityRule {
  guarded_acceptance_and_rejection,  ///< pass inside by the guard band, fail outside by it, else inconclusive
  simple,                            ///< 4.2.1: pass inside the tolerance, else fail; up to 50 % risk at the limit
  guarded,                           ///< 4.2.2: pass inside by the guard band, else fail
  non_binary,                        ///< 4.2.3: the stretches between are a conditional pass and a conditional fail
};
inline constexpr std::array conformity_rules{ConformityRule::guarded_acceptance_and_rejection, ConformityRule::simple,
                                             ConformityRule::guarded, ConformityRule::non_binary};
[[nodiscard]] std::string_view to_string(ConformityRule rule);

}  // namespace todbench
