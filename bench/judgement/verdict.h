// Pass, fail or inconclusive: the limits of a plan against what was measured, and the exit code of the program.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/plan/plan.h"
#include "tod/comparison/comparison.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

enum class VerdictKind { pass, fail, inconclusive };
[[nodiscard]] std::string_view to_string(VerdictKind kind);

/// One demand with what was found.
struct VerdictItem {
  std::string demand;           ///< "acuity at 16.9 K at least 0.4 1/mrad"
  double delta_t_k = 0;         ///< 0 where the demand is not about one contrast
  std::optional<double> limit;  ///< in the unit of the demand
  std::optional<double> value;  ///< measured
  Interval interval;            ///< 95 %
  VerdictKind kind = VerdictKind::inconclusive;
  std::string reason;  ///< a sentence
};

struct Verdict {
  VerdictKind overall = VerdictKind::pass;  ///< fail if any item fails, else inconclusive if any is, else pass
  std::vector<VerdictItem> items;           ///< empty: nothing was demanded and every threshold was identified
  std::string rule;                         ///< the decision rule in words
};

/// The decision rule: guarded acceptance and guarded rejection with the 95 % confidence interval of the result as guard
/// band (ILAC-G8:09/2019, 4.2; JCGM 106:2012, 8.3).
[[nodiscard]] std::string decision_rule();

/// A fit says where the threshold is: it has a point and both sides of its interval, and its slope is not at the lower
/// bound.
[[nodiscard]] bool threshold_identified(const PsychometricFit& fit);

/// Judges the limits of a plan. A limit on acuity passes when the whole 95 % interval is at or above it (exactly on the
/// limit passes), fails when the whole interval is below it, and is inconclusive otherwise; a one-sided limit of the
/// fit decides in its direction. Where a free lapse explains the data significantly better, both fits have to agree:
/// the union of their intervals counts. Demanded equivalence passes, fails or stays open as the comparison says. A
/// contrast without a limit whose threshold cannot be identified is inconclusive.
[[nodiscard]] Verdict judge(const LimitsPlan& limits, const TodCurve& curve,
                            const std::optional<Comparison>& comparison);

/// Exit codes: 0 pass, 1 fail, 3 inconclusive.
[[nodiscard]] int exit_code(VerdictKind kind);
[[nodiscard]] int exit_code(const PsychometricFit& fit);
/// 2 invalid_input, 4 not_found, 5 disconnected, integrity, timeout, 6 calibration, 7 io (a full disk) and internal,
/// 130 interrupted.
[[nodiscard]] int exit_code(ErrorCode code);

}  // namespace todbench
