// SPDX-License-Identifier: GPL-3.0-or-later
// Self-test of an installed program: results on this computer compared with known answers (ISO/IEC 17025:2017, 7.11.2).
#pragma once

#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// Result on this computer with its known answer.
struct SelftestCase {
  std::string_view group;  ///< origin of the answer, see selftest_groups()
  std::string name;
  double value = 0, expected = 0;
  double tolerance = 0;  ///< permitted difference
  /// Returns whether the difference is within the tolerance; false if one of the values is NaN.
  [[nodiscard]] bool ok() const;
};

/// Group of cases, and the origin of its answers in words.
struct SelftestGroup {
  std::string_view name, answers;
};
/// Returns the groups in the order of selftest().
[[nodiscard]] std::vector<SelftestGroup> selftest_groups();

/// Computes all cases: closed forms, references with 50 digits, hard cases, numbers of every part of the program,
/// equality of the bits on two threads, and the first case of the reference set. Takes about half a second of processor
/// time. Errors: `interrupted`.
[[nodiscard]] Result<std::vector<SelftestCase>> selftest(std::stop_token stop);

}  // namespace todbench
