// SPDX-License-Identifier: GPL-3.0-or-later
// Sealed file of a coordinator: the true values of blind items.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/round_robin/comparison.h"

namespace todbench {

/// True value of one quantity of an item.
struct SealedValue {
  std::string item, quantity;
  double value = 0, u = 0;
};

inline constexpr std::string_view sealed_schema = "todbench-round-robin-1";

/// Reads a sealed file. Errors: `invalid_input` (not such a file, value not finite, uncertainty below 0).
[[nodiscard]] Result<std::vector<SealedValue>> read_sealed(const std::filesystem::path& file);

/// Comparison of the reference value of an item with its true value.
struct TruthCheck {
  SealedValue truth;
  double difference = 0;  ///< reference value minus true value
  double e_n = 0;         ///< difference / sqrt(U^2 + 4 u^2), U: expanded_u of the reference value, u: truth.u
  bool held = false;      ///< |e_n| <= 1: the interval of the reference value contains the true value
};
/// Returns the checks in the order of the items. Errors: `invalid_input` for an item or quantity that was not sealed.
[[nodiscard]] Result<std::vector<TruthCheck>> checked_against(const RoundRobin& found,
                                                              const std::vector<SealedValue>& sealed);

}  // namespace todbench
