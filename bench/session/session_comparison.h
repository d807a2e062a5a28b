// Two sessions side by side: whether they can be compared, and what comes of it.
#pragma once

#include <optional>

#include "bench/session/session_folder.h"

namespace todbench {

/// The curves as they were compared: examined, where their session stored no findings.
struct SessionComparison {
  TodCurve a, b;
  Comparison comparison;
};

/// Compares the curves of two sessions within `margin_percent`, or within the smaller margin of their plans (10 % where
/// neither has one). Exchanged arguments give inverse ratios and the same verdicts and refusals. What was shown on
/// other plates is compared, with a finding that leaves it undecided. `invalid_input`, one sentence: a session without
/// a curve, the same trials (or a part of them) in both, another form or lapse of the fit, another observer or one with
/// other parameters, and as compare().
[[nodiscard]] Result<SessionComparison> compare_sessions(const Session& a, const Session& b,
                                                         std::optional<double> margin_percent);

}  // namespace todbench
