// An uncertainty budget: rows, their combination by the GUM, and its check by Monte Carlo.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/plan/budget_row.h"

namespace todbench {

struct UncertaintyBudget {
  std::string quantity{};
  std::string unit{};  ///< of the result
  std::vector<BudgetRow> rows;
};

/// A row's part.
struct BudgetShare {
  double standard_uncertainty = 0;  ///< in the row's unit
  double contribution = 0;          ///< |sensitivity| times that, in the result's unit
  double share_percent = 0;         ///< of the variance
};

struct CombinedUncertainty {
  double u = 0;                     ///< standard
  std::optional<double> nu_eff{};   ///< Welch-Satterthwaite; nothing: very many
  double k = 0;                     ///< Student's t for 95 %, of nu_eff as it is
  double expanded_gum = 0;          ///< k u
  double expanded_monte_carlo = 0;  ///< half-width of the 95 % interval (JCGM 101:2008)
  double expanded = 0;              ///< the larger of both
  std::vector<BudgetShare> shares;  ///< of each row
};

/// Draws of the Monte Carlo check: the half-width is known to 0.15 % (one standard error) or better.
inline constexpr int budget_draws = 1000000;
/// The same in a session, for every contrast: 0.35 %.
inline constexpr int session_budget_draws = 200000;

/// `invalid_input` in one sentence that names the row: no rows, two of one name, a negative value or one that is no
/// number, degrees of freedom below 1, rows in different units without a sensitivity that converts them, or nothing
/// uncertain at all. The seed makes the draws; with none of them `expanded` is that of the GUM.
[[nodiscard]] Result<CombinedUncertainty> combined(const UncertaintyBudget& budget, std::uint64_t seed,
                                                   int draws = budget_draws);

/// Reads the file of `todbench budget` (docs/conformity.md). `invalid_input` with file and line.
[[nodiscard]] Result<UncertaintyBudget> read_budget(const std::filesystem::path& file);
[[nodiscard]] Result<UncertaintyBudget> parse_budget(std::string_view text, const std::string& name);

}  // namespace todbench
