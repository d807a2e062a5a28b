// SPDX-License-Identifier: GPL-3.0-or-later
// Dependence of a response on the parameters of a sweep: main effects and Sobol indices with intervals.
#pragma once

#include <string>
#include <vector>

#include "bench/sweep/sweep_table.h"

namespace todbench {

/// Mean response at one value of a parameter over all other parameters, with the 95 % interval of the mean over the
/// repeats. For a drawn parameter, the value is the mean of a class.
struct EffectLevel {
  std::string value;
  double mean = 0;
  Interval ci95;  ///< open with one repeat
  std::size_t rows = 0;
};
/// Effect of one parameter.
struct ParameterEffect {
  std::string key;
  std::vector<EffectLevel> levels{};
  /// For a drawn parameter: response at both limits of its range, with all other parameters at their means. The
  /// response is computed on the plane fitted to all rows of a repeat, and averaged over the repeats. The joint
  /// least-squares fit removes the linear effects of the other parameters from the noise.
  std::vector<EffectLevel> ends{};
  /// Shares of the variance of the response that are explained by the parameter alone, and by the parameter with all
  /// its interactions. Both shares are means over the repeats, with the intervals of these means. Full factorial: exact
  /// sums of squares. Drawn sample: the correlation ratio over classes of equal count, corrected for chance; there is
  /// no total index. Draws with total = true: the estimators of Saltelli et al. 2010 and Jansen 1999, with intervals
  /// over the draws.
  std::optional<double> first_order{}, total{};
  Interval first_order_ci95{}, total_ci95{};
};
/// Effects on one numeric column, separately for each contrast (column delta_t_k).
struct ResponseEffects {
  std::string response;
  double delta_t_k = 0;
  std::vector<ParameterEffect> parameters;
  std::size_t draws = 0;  ///< number of complete draws with total indices; 0: none
};
/// Returns the effects on a response; empty if the response has no numbers.
[[nodiscard]] std::vector<ResponseEffects> sweep_effects(const Sweep& sweep, const SweepTable& table,
                                                         const std::string& response);
/// Returns the effects as JSON.
[[nodiscard]] Json to_json(const std::vector<ResponseEffects>& effects);

}  // namespace todbench
