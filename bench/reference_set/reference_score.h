// How far somebody's thresholds are from those of the reference set.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/reference_set/reference_case.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// A row of a result.
struct ReferenceResult {
  std::string name;
  double s75_mrad = 0;
  std::optional<Interval> ci95_mrad;  ///< both sides
};
/// Columns case, s75_mrad and, both or neither, s75_ci95_low_mrad, s75_ci95_high_mrad, in any order; one row for each
/// of `truths`. `invalid_input` "NAME:LINE: ..." for a column that is unknown, missing or there twice, a case that is
/// unknown or there twice, a size that is no number above 0, an interval that does not hold it, and a case without a
/// row.
[[nodiscard]] Result<std::vector<ReferenceResult>> parse_reference_result(std::string_view text, std::string_view name,
                                                                          std::span<const ReferenceTruth> truths);

struct CaseScore {
  ReferenceTruth truth;
  ReferenceResult result;
  double deviation_percent = 0;
  bool within = false;                 ///< the tolerance
  std::optional<bool> interval_holds;  ///< the threshold
};
struct ReferenceScore {
  std::vector<CaseScore> cases;       ///< in the order of the truths
  double mean_deviation_percent = 0;  ///< of the logarithm: a common bias
  double rms_deviation_percent = 0;
  bool passed = false;  ///< every case is within the tolerance
};
[[nodiscard]] ReferenceScore score(std::span<const ReferenceTruth> truths, std::span<const ReferenceResult> results);

}  // namespace todbench
