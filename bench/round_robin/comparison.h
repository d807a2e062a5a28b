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
  std::string item, quantity, unit;  ///< an empty unit: the name of the quantity contains it, as "s75_mrad" does
  std::vector<LaboratoryValue> results;
};

/// Kind of reference value (assigned value of ISO 13528).
enum class ReferenceMethod {
  weighted_mean,  ///< Cox 2002, procedure A: the results that are not outlying are consistent
  median,         ///< Cox 2002, procedure B: they are not, but at least three quarters of them are
  paule_mandel,   ///< they scatter more than their uncertainties explain
};
[[nodiscard]] std::string_view to_string(ReferenceMethod method);

struct ReferenceValue {
  ReferenceMethod method = ReferenceMethod::weighted_mean;
  Consensus value;
  double k = 2;           ///< coverage factor of 95 %: 2, or Student's t with N - 1 for Paule and Mandel
  double expanded_u = 0;  ///< k u; for the median half of its shortest interval
};

/// Result of a laboratory against the reference value.
struct DegreeOfEquivalence {
  LaboratoryValue result;
  double difference = 0;  ///< value minus reference value
  double expanded_u = 0;  ///< of the difference, k = 2
  double e_n = 0;         ///< difference / expanded_u
  double zeta = 0;        ///< 2 e_n
  bool in_reference = true;
  bool outlying = false;  ///< the result, or its laboratory
};

struct ItemComparison {
  ComparedItem item;
  ReferenceValue reference;
  ConsistencyCheck all, kept;  ///< of all results, and of those that are not outlying
  std::vector<DegreeOfEquivalence> degrees;
  // Other estimates, from the results that the reference value comes from.
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
  double combined_zeta = 0;  ///< sum of its zeta against the other laboratories over sqrt(items); standard normal
  double p = 1;              ///< of a combined zeta so large by chance, for this laboratory alone
  bool outlying = false;
};

/// Laboratory, or single result, that chance does not explain.
struct OutlyingResult {
  std::string laboratory, item, quantity;  ///< empty item: the laboratory over all its items
  double zeta = 0;                         ///< against the others that were kept when it was found
  double p = 0;                            ///< of such a deviation of any laboratory by chance
};

struct RoundRobin {
  std::vector<ItemComparison> items;
  std::vector<LaboratorySummary> laboratories;  ///< by name
  std::vector<OutlyingResult> outlying;         ///< in the order in which they were found
  /// Several laboratories are outlying: reference values and estimates come from all results, because the others agree
  /// by selection.
  bool reference_from_all = false;
  /// No result outlying and every item consistent.
  [[nodiscard]] bool consistent() const;
};

/// Probability that a comparison of correct laboratories names one of them or one of their results.
inline constexpr double outlying_significance = 0.025;

/// Evaluates a comparison. The errors of a laboratory are taken as independent between items. The most improbable
/// outlying laboratory or result is set aside and the rest tested again. If this would leave no more than half of the
/// laboratories of an item, none is set aside. If several laboratories are outlying, all may understate their
/// uncertainties: the reference values then come from all results. `seed` draws the medians. Errors: `invalid_input`
/// (no item, or an item with fewer than two laboratories).
[[nodiscard]] Result<RoundRobin> evaluated(std::vector<ComparedItem> items, std::uint64_t seed);

}  // namespace todbench
