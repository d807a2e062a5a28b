// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison of submitted thresholds with the true thresholds of the reference set.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/reference_set/reference_case.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Row of a result.
struct ReferenceResult {
  std::string name;
  double s75_mrad = 0;
  std::optional<Interval> ci95_mrad;  ///< 95 % interval with both limits
};
/// Parses a CSV text with the columns case, s75_mrad and optionally the pair s75_ci95_low_mrad, s75_ci95_high_mrad, in
/// any order. Requires one row for each of `truths`. Errors: `invalid_input` "NAME:LINE: ..." (column unknown, missing
/// or repeated; case unknown, repeated or without a row; size not above 0; interval that does not contain the size).
[[nodiscard]] Result<std::vector<ReferenceResult>> parse_reference_result(std::string_view text, std::string_view name,
                                                                          std::span<const ReferenceTruth> truths);

/// Score of one case.
struct CaseScore {
  ReferenceTruth truth;
  ReferenceResult result;
  double deviation_percent = 0;
  bool within = false;                 ///< within the tolerance
  std::optional<bool> interval_holds;  ///< true if the interval contains the true threshold; empty: no interval
};
/// Score of all cases.
struct ReferenceScore {
  std::vector<CaseScore> cases;       ///< scores in the order of the truths
  double mean_deviation_percent = 0;  ///< mean of the deviations in the logarithm: a common bias
  double rms_deviation_percent = 0;
  bool passed = false;  ///< every case is within the tolerance
};
/// Returns the score of these results.
[[nodiscard]] ReferenceScore score(std::span<const ReferenceTruth> truths, std::span<const ReferenceResult> results);

}  // namespace todbench
