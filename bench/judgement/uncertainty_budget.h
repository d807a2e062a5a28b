// SPDX-License-Identifier: GPL-3.0-or-later
// Uncertainty budget: rows, their combination by the GUM (JCGM 100:2008), and a Monte Carlo check.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/plan/budget_row.h"

namespace todbench {

/// Budget of one quantity.
struct UncertaintyBudget {
  std::string quantity{};
  std::string unit{};  ///< unit of the result
  std::vector<BudgetRow> rows;
};

/// Contribution of a row.
struct BudgetShare {
  double standard_uncertainty = 0;  ///< standard uncertainty in the unit of the row
  double contribution = 0;          ///< absolute sensitivity times standard_uncertainty, in the unit of the result
  double share_percent = 0;         ///< share of the variance
};

/// Uncertainty from all rows of a budget.
struct CombinedUncertainty {
  double u = 0;                     ///< standard uncertainty
  std::optional<double> nu_eff{};   ///< effective degrees of freedom (JCGM 100:2008, G.4); empty: infinite
  double k = 0;                     ///< Student's t for 95 % and nu_eff, not truncated
  double expanded_gum = 0;          ///< k u
  double expanded_monte_carlo = 0;  ///< half-width of the 95 % interval (JCGM 101:2008)
  double expanded = 0;              ///< the larger of both
  std::vector<BudgetShare> shares;  ///< one per row
};

/// Draws of the Monte Carlo check: the half-width has a standard error of at most 0.15 %.
inline constexpr int budget_draws = 1000000;
/// Draws for each contrast of a session: the half-width has a standard error of 0.35 %.
inline constexpr int session_budget_draws = 200000;

/// Combines the rows. `seed` seeds the draws. If `draws` is 0, `expanded` equals `expanded_gum`. Errors:
/// `invalid_input` that names the row (no rows, duplicate name, negative or non-finite value, degrees of freedom below
/// 1, different units without a sensitivity, total uncertainty of 0).
[[nodiscard]] Result<CombinedUncertainty> combined(const UncertaintyBudget& budget, std::uint64_t seed,
                                                   int draws = budget_draws);

/// Reads the file of `todbench budget` (docs/method/conformity.md). Errors: `invalid_input` with file and line.
[[nodiscard]] Result<UncertaintyBudget> read_budget(const std::filesystem::path& file);
/// Parses the text of a budget file. `name`: name of the text in messages.
[[nodiscard]] Result<UncertaintyBudget> parse_budget(std::string_view text, const std::string& name);

}  // namespace todbench
