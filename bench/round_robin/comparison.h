// SPDX-License-Identifier: GPL-3.0-or-later
// Evaluation of an interlaboratory comparison: reference values, degrees of equivalence, E_n, outlying laboratories
// (Cox 2002; ISO 13528; ISO/IEC 17043).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/round_robin/consensus.h"

namespace todbench {

/// Measurand of the comparison with the results of its laboratories, in the order of their names.
struct ComparedItem {
  std::string item, quantity, unit;  ///< empty unit: the name of the quantity contains the unit, for example "s75_mrad"
  std::vector<LaboratoryValue> results;
};

/// Kind of reference value (assigned value of ISO 13528).
enum class ReferenceMethod {
  weighted_mean,  ///< Cox 2002, procedure A: the results that are not outlying are consistent
  median,         ///< Cox 2002, procedure B: not all results are consistent, but three quarters or more are
  paule_mandel,   ///< the results scatter more than their uncertainties explain
};
/// Returns the name of the enumerator.
[[nodiscard]] std::string_view to_string(ReferenceMethod method);

/// Reference value of an item.
struct ReferenceValue {
  ReferenceMethod method = ReferenceMethod::weighted_mean;
  Consensus value;
  double k = 2;           ///< coverage factor of 95 %: 2; Paule and Mandel: Student's t with (number of results - 1)
  double expanded_u = 0;  ///< k u; for the median, half of the shortest 95 % interval
};

/// Result of a laboratory against the reference value.
struct DegreeOfEquivalence {
  LaboratoryValue result;
  double difference = 0;  ///< value minus reference value
  double expanded_u = 0;  ///< expanded uncertainty of the difference, k = 2
  double e_n = 0;         ///< difference / expanded_u
  double zeta = 0;        ///< 2 e_n
  bool in_reference = true;
  bool outlying = false;  ///< the result or its laboratory is outlying
};

/// Evaluation of one item.
struct ItemComparison {
  ComparedItem item;
  ReferenceValue reference;
  ConsistencyCheck all, kept;  ///< checks of all results, and of the results that are not outlying
  std::vector<DegreeOfEquivalence> degrees;
  // Other estimates, from the same results as the reference value.
  Consensus weighted, median;
  RandomEffects dersimonian_laird, paule_mandel;
  double dersimonian_laird_sd = 0, paule_mandel_sd = 0;  ///< between laboratories
  std::vector<std::string> consistent_laboratories;      ///< largest consistent subset of all results
  Consensus consistent_subset;                           ///< weighted mean of that subset
};

/// Deviation of a laboratory over all its items.
struct LaboratorySummary {
  std::string laboratory;
  int items = 0;
  double combined_zeta = 0;  ///< sum of the zeta against the other laboratories, over sqrt(items); standard normal
  double p = 1;              ///< chance probability of at least this combined zeta, for this laboratory alone
  bool outlying = false;
};

/// Laboratory or single result with a deviation that is too large to be random.
struct OutlyingResult {
  std::string laboratory, item, quantity;  ///< empty item: the laboratory over all its items
  double zeta = 0;                         ///< zeta against the results that were not yet excluded when this result
                                           ///< was found
  double p = 0;                            ///< probability that any laboratory has a deviation of this size by chance
};

/// Evaluation of a comparison.
struct RoundRobin {
  std::vector<ItemComparison> items;
  std::vector<LaboratorySummary> laboratories;  ///< by name
  std::vector<OutlyingResult> outlying;         ///< outlying results in the order in which they were found
  /// True if several laboratories are outlying. Reference values and estimates then come from all results, because the
  /// agreement of the other laboratories is a consequence of the selection.
  bool reference_from_all = false;
  /// Returns whether no result is outlying and every item is consistent.
  [[nodiscard]] bool consistent() const;
};

/// Probability that a comparison of correct laboratories reports one of them or one of their results as outlying.
inline constexpr double outlying_significance = 0.025;

/// Evaluates a comparison. The errors of a laboratory are assumed to be independent between items. The most improbable
/// outlying laboratory or result is excluded, and the remaining results are tested again. All exclusions are withdrawn
/// if at most half of the laboratories of an item would remain. If several laboratories are outlying, all of them may
/// understate their uncertainties; the reference values then come from all results. `seed`: seed of the draws for the
/// medians. Errors: `invalid_input` (no item, or an item with fewer than two laboratories).
[[nodiscard]] Result<RoundRobin> evaluated(std::vector<ComparedItem> items, std::uint64_t seed);

}  // namespace todbench
