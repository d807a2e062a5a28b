// What a response depends on, from the table of a sweep: main effects and Sobol indices with intervals.
#pragma once

#include <string>
#include <vector>

#include "bench/sweep/sweep_table.h"

namespace todbench {

/// Mean response at one value of a parameter (of a drawn one at the mean of a class), over everything else, with the 95
/// % interval of the mean over the repeats.
struct EffectLevel {
  std::string value;
  double mean = 0;
  Interval ci95;  ///< open with one repeat
  std::size_t rows = 0;
};
struct ParameterEffect {
  std::string key;
  std::vector<EffectLevel> levels{};
  /// Of a drawn parameter: the response at the two ends of its range, everything else at its mean, on the plane through
  /// all rows of a repeat (least squares over all parameters together, so that the others' linear parts do not count as
  /// noise); averaged over the repeats.
  std::vector<EffectLevel> ends{};
  /// Share of the variance of the response that the parameter alone explains, and with all its interactions; of each
  /// repeat, averaged, with the interval of that mean. In a full factorial exact sums of squares; of a drawn sample the
  /// correlation ratio over classes of equal count, corrected for what they explain by chance (no total). Of draws with
  /// total = true the estimators of Saltelli et al. 2010 and Jansen 1999, with intervals over the draws.
  std::optional<double> first_order{}, total{};
  Interval first_order_ci95{}, total_ci95{};
};
/// The effects on one numeric column, at each contrast apart (column delta_t_k).
struct ResponseEffects {
  std::string response;
  double delta_t_k = 0;
  std::vector<ParameterEffect> parameters;
  std::size_t draws = 0;  ///< whole ones, of which total indices are; 0: not drawn for them
};
/// Empty where the response has no numbers.
[[nodiscard]] std::vector<ResponseEffects> sweep_effects(const Sweep& sweep, const SweepTable& table,
                                                         const std::string& response);
[[nodiscard]] Json to_json(const std::vector<ResponseEffects>& effects);

}  // namespace todbench
