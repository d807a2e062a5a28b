// An uncertainty budget: rows, their combination by the GUM, and its check by Monte Carlo.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

/// What a row's value means.
enum class BudgetDistribution {
  normal,       ///< a standard uncertainty, or an expanded one with its coverage factor
  rectangular,  ///< the half-width of a rectangle
  triangular,   ///< the half-width of a triangle
  u_shaped,     ///< the amplitude of something that swings like a sine
};
inline constexpr std::array budget_distributions{BudgetDistribution::normal, BudgetDistribution::rectangular,
                                                 BudgetDistribution::triangular, BudgetDistribution::u_shaped};
[[nodiscard]] std::string_view to_string(BudgetDistribution distribution);

/// With what a row is shared: it cancels in a ratio to it, or in a trend.
enum class BudgetCommon { twin, series, contrasts };
inline constexpr std::array budget_commons{BudgetCommon::twin, BudgetCommon::series, BudgetCommon::contrasts};
[[nodiscard]] std::string_view to_string(BudgetCommon common);

/// One source of uncertainty. Rows are independent of each other.
struct BudgetRow {
  std::string name;
  double value = 0;  ///< 0 or more, in `unit`
  BudgetDistribution distribution = BudgetDistribution::normal;
  double coverage_factor = 1;                  ///< of a normal value: value / coverage_factor is standard
  std::optional<double> degrees_of_freedom{};  ///< nothing: very many
  std::optional<double> sensitivity{};  ///< of the result to this row; nothing: 1, the row is in the result's unit
  std::string unit{};
  std::string source{};       ///< what the value rests on
  std::string certificate{};  ///< its number
  std::vector<BudgetCommon> common{};
};

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

/// `invalid_input` in one sentence that names the row: no rows, two of one name, a negative value or one that is no
/// number, degrees of freedom below 1, rows in different units without a sensitivity that converts them, or nothing
/// uncertain at all. The seed makes the draws.
[[nodiscard]] Result<CombinedUncertainty> combined(const UncertaintyBudget& budget, std::uint64_t seed);

/// Reads the file of `todbench budget` (docs/conformity.md). `invalid_input` with file and line.
[[nodiscard]] Result<UncertaintyBudget> read_budget(const std::filesystem::path& file);
[[nodiscard]] Result<UncertaintyBudget> parse_budget(std::string_view text, const std::string& name);

}  // namespace todbench
