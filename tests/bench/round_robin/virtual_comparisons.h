// SPDX-License-Identifier: GPL-3.0-or-later
// Virtual interlaboratory comparisons with known truth: coverage of reference values, biases found, false alarms.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "acquisition/base/rng.h"
#include "bench/round_robin/comparison.h"

namespace todbench::testing {

struct VirtualDesign {
  int comparisons = 300, laboratories = 8, items = 3;
  double bias_u = 0;     ///< of one laboratory in all its items, in its standard uncertainties
  double scatter_u = 0;  ///< sd between laboratories, new for every item, in units of the median uncertainty
  std::uint64_t seed = 1;
};

/// Shares over the comparisons or over their items.
struct VirtualSummary {
  double held = 0;         ///< items whose interval of the reference value holds the truth
  double found = 0;        ///< comparisons that name the biased laboratory
  double false_alarm = 0;  ///< comparisons that name another one
  double e_n_above = 0;    ///< results of the biased laboratory with |E_n| > 1; without bias, of all laboratories
  double procedure_a = 0;  ///< items with a weighted mean
};

/// Result of a laboratory: truth, bias, scatter and an error of its stated uncertainty. The uncertainties of the
/// laboratories are spread from half to twice the median, evenly in their logarithm.
inline std::vector<ComparedItem> virtual_items(const VirtualDesign& design, const RandomStream& stream, int biased) {
  std::vector<ComparedItem> items;
  for (int j = 0; j < design.items; ++j) {
    const double truth = 2 + 1.5 * j, median_u = 0.03 * truth;
    ComparedItem item{"item " + std::to_string(j), "s75_mrad", "", {}};
    for (int i = 0; i < design.laboratories; ++i) {
      const RandomStream draw = stream.sub(static_cast<std::uint64_t>(100 * j + i));
      const double u = median_u * std::exp2(2 * stream.uniform(static_cast<std::uint64_t>(10 + i)) - 1);
      const double error = u * static_cast<double>(draw.normal(0)) +
                           design.scatter_u * median_u * static_cast<double>(draw.normal(1)) +
                           (i == biased ? design.bias_u * u : 0);
      item.results.push_back({"laboratory " + std::to_string(i), truth + error, u});
    }
    items.push_back(std::move(item));
  }
  return items;
}

inline VirtualSummary summary_of(const VirtualDesign& design) {
  const RandomStream all(design.seed, "virtual_comparisons");
  VirtualSummary out;
  double judged = 0;
  for (int c = 0; c < design.comparisons; ++c) {
    const RandomStream stream = all.sub(static_cast<std::uint64_t>(c));
    const int biased =
        design.bias_u == 0 ? -1 : static_cast<int>(stream.below(static_cast<std::uint64_t>(design.laboratories), 0));
    const std::string name = "laboratory " + std::to_string(biased);
    const RoundRobin found = *evaluated(virtual_items(design, stream, biased), design.seed);
    const auto is_biased = [&](const OutlyingResult& one) { return one.laboratory == name; };
    out.found += std::ranges::any_of(found.outlying, is_biased) ? 1 : 0;
    out.false_alarm += std::ranges::all_of(found.outlying, is_biased) ? 0 : 1;
    for (int j = 0; j < design.items; ++j) {
      const ItemComparison& item = found.items[static_cast<std::size_t>(j)];
      const double truth = 2 + 1.5 * j;
      out.held += std::abs(item.reference.value.value - truth) <= item.reference.expanded_u ? 1 : 0;
      out.procedure_a += item.reference.method == ReferenceMethod::weighted_mean ? 1 : 0;
      for (const DegreeOfEquivalence& degree : item.degrees) {
        if (biased >= 0 && degree.result.laboratory != name) continue;
        judged += 1;
        out.e_n_above += std::abs(degree.e_n) > 1 ? 1 : 0;
      }
    }
  }
  const double n = design.comparisons;
  out.held /= n * design.items;
  out.procedure_a /= n * design.items;
  out.found /= n;
  out.false_alarm /= n;
  out.e_n_above /= judged;
  return out;
}

}  // namespace todbench::testing
