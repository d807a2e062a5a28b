// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/judgement/uncertainty_budget.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "acquisition/base/distributions.h"
#include "acquisition/base/rng.h"
#include "acquisition/base/try.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

double sensitivity_of(const BudgetRow& row) {
  return row.sensitivity.value_or(1);
}

tl::unexpected<Error> wrong(const BudgetRow& row, const std::string& sentence) {
  return fail(ErrorCode::invalid_input, "row '" + one_line(row.name) + "': " + sentence);
}

/// Requires that a row without a conversion has the unit of the result.
Result<void> check_units(const UncertaintyBudget& budget) {
  const BudgetRow* first = nullptr;
  for (const BudgetRow& row : budget.rows) {
    if (row.sensitivity) continue;
    if (!budget.unit.empty() && !row.unit.empty() && row.unit != budget.unit) {
      return wrong(row, "has the unit '" + one_line(row.unit) + "', but the result has '" + one_line(budget.unit) +
                            "': add a sensitivity that converts the unit");
    }
    if (!first) first = &row;
    if (row.unit == first->unit) continue;
    const auto said = [](const std::string& unit) {
      return unit.empty() ? "no unit" : "the unit '" + one_line(unit) + "'";
    };
    return wrong(row, "has " + said(row.unit) + ", but row '" + one_line(first->name) + "' has " + said(first->unit) +
                          ": rows with different units need a sensitivity");
  }
  return {};
}

Result<void> check(const UncertaintyBudget& budget) {
  if (budget.rows.empty()) return fail(ErrorCode::invalid_input, "the budget has no rows");
  std::set<std::string> names;
  for (const BudgetRow& row : budget.rows) {
    if (!names.insert(row.name).second) return wrong(row, "occurs twice");
    if (!std::isfinite(row.value) || row.value < 0)
      return wrong(row, "the uncertainty must be a number of at least 0, found " + fmt::format("{}", row.value));
    if (!(std::isfinite(row.coverage_factor) && row.coverage_factor > 0))
      return wrong(row, "the coverage factor must be greater than 0");
    if (row.coverage_factor != 1 && row.distribution != BudgetDistribution::normal)
      return wrong(row, "only a normal distribution has a coverage factor");
    if (row.degrees_of_freedom && !(*row.degrees_of_freedom >= 1))
      return wrong(row, "expected at least one degree of freedom");
    if (row.sensitivity && !std::isfinite(*row.sensitivity))
      return wrong(row, "the sensitivity is not a finite number");
  }
  return check_units(budget);
}

/// Draws of a row: standard deviation 1, or scaled Student's t for a normal row with finite degrees of freedom.
class RowDraws {
 public:
  RowDraws(const BudgetRow& row, RandomStream random) : row_(row), random_(random) {}
  [[nodiscard]] double operator()(std::uint64_t index) const {
    const double first = random_.uniform(2 * index);
    switch (row_.distribution) {
      case BudgetDistribution::rectangular:
        return std::numbers::sqrt3 * (2 * first - 1);
      case BudgetDistribution::triangular:
        return std::sqrt(6.0) * (first + random_.uniform(2 * index + 1) - 1);
      case BudgetDistribution::u_shaped:
        return std::numbers::sqrt2 * std::cos(2 * std::numbers::pi * first);
      case BudgetDistribution::normal:
        break;
    }
    // Student's t with any degrees of freedom from two uniform numbers (Bailey 1994); its limit is the method of Box
    // and Muller.
    const double angle = std::cos(2 * std::numbers::pi * random_.uniform(2 * index + 1));
    const double nu = row_.degrees_of_freedom.value_or(0);
    const double square = row_.degrees_of_freedom ? nu * std::expm1(-2 / nu * std::log(first)) : -2 * std::log(first);
    return std::sqrt(square) * angle;
  }

 private:
  const BudgetRow& row_;
  RandomStream random_;
};

/// Returns the bound below which 95 % of |sum| lie; every row is symmetric.
double monte_carlo_half_width(const UncertaintyBudget& budget, const std::vector<BudgetShare>& shares,
                              std::uint64_t seed, int draws) {
  std::vector<double> sums(static_cast<std::size_t>(draws), 0.0);
  for (std::size_t r = 0; r < budget.rows.size(); ++r) {
    if (shares[r].contribution == 0) continue;
    const RowDraws draw(budget.rows[r], RandomStream(seed, "uncertainty budget").sub(r));
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += shares[r].contribution * draw(i);
  }
  for (double& sum : sums) sum = std::abs(sum);
  const auto at = sums.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(sums.size()));
  std::nth_element(sums.begin(), at, sums.end());
  return *at;
}

}  // namespace

Result<CombinedUncertainty> combined(const UncertaintyBudget& budget, std::uint64_t seed, int draws) {
  TODBENCH_TRY_VOID(check(budget));
  CombinedUncertainty out;
  double largest = 0;
  for (const BudgetRow& row : budget.rows) {
    const double standard = standard_of(row);
    out.shares.push_back({standard, std::abs(sensitivity_of(row)) * standard, 0});
    largest = std::max(largest, out.shares.back().contribution);
  }
  if (!(largest > 0)) return fail(ErrorCode::invalid_input, "all contributions to the budget are 0");
  if (!std::isfinite(largest))
    return fail(ErrorCode::invalid_input,
                "a contribution is too large: check the values and sensitivities of the rows");
  // In units of the largest row, squares cannot overflow.
  double variance = 0, fourth = 0;
  for (std::size_t r = 0; r < out.shares.size(); ++r) {
    const double square = std::pow(out.shares[r].contribution / largest, 2);
    variance += square;
    if (const auto& nu = budget.rows[r].degrees_of_freedom) fourth += square * square / *nu;
  }
  for (auto& share : out.shares) share.share_percent = 100 * std::pow(share.contribution / largest, 2) / variance;
  out.u = largest * std::sqrt(variance);
  constexpr double upper = 0.025;
  if (fourth > 0) out.nu_eff = variance * variance / fourth;
  out.k = distribution::quantile_above(upper, out.nu_eff);
  out.expanded_gum = out.k * out.u;
  if (draws > 0) out.expanded_monte_carlo = monte_carlo_half_width(budget, out.shares, seed, draws);
  out.expanded = std::max(out.expanded_gum, out.expanded_monte_carlo);
  if (!std::isfinite(out.expanded))
    return fail(ErrorCode::invalid_input,
                "a contribution is too large: check the values and sensitivities of the rows");
  return out;
}

}  // namespace todbench
