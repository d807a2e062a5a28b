// SPDX-License-Identifier: GPL-3.0-or-later
// Results of laboratories: CSV files of any program, and session folders of todbench.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/round_robin/comparison.h"

namespace todbench {

/// Result of a laboratory for one quantity of an item.
struct SubmittedResult {
  std::string laboratory, item, quantity, unit;
  double value = 0, u = 0;
  std::string source;  ///< "results.csv:7", for messages
};

/// Parses a CSV file, columns in any order: laboratory, item, quantity, value and the uncertainty as u (standard), or
/// expanded_u with an optional k (default 2), or ci95_low and ci95_high; optionally unit. Each row states the
/// uncertainty in one of these three forms. Errors: `invalid_input` "NAME:LINE: ..." (column unknown, missing or
/// repeated; empty name; number missing, not finite or beyond 1e30; uncertainty not above 0, below 1e-30, or stated
/// twice).
[[nodiscard]] Result<std::vector<SubmittedResult>> parse_submitted_results(std::string_view text,
                                                                           std::string_view name);

/// Reads the values of one session folder. The laboratory is the `place` of its plan, and the item is the `unit` of its
/// plan. The quantities are the acuity by set contrast and the measures that have an uncertainty. Logarithms are
/// transformed back. The uncertainty of an acuity includes the budget rows that are common to a series. Errors: those
/// of read_history_session() and open_session(); `invalid_input` if the plan names no place or no unit.
[[nodiscard]] Result<std::vector<SubmittedResult>> session_results(const std::filesystem::path& folder);

/// Groups results by item and quantity, in the order of their names. Errors: `invalid_input` (a laboratory twice for
/// the same item and quantity; different units of one quantity).
[[nodiscard]] Result<std::vector<ComparedItem>> compared_items(const std::vector<SubmittedResult>& results);

}  // namespace todbench
