// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison of two sessions: precondition checks and result.
#pragma once

#include <optional>

#include "bench/session/session_folder.h"

namespace todbench {

/// Compared curves. compare_sessions() tests a curve for adequacy if its session stored no findings.
struct SessionComparison {
  TodCurve a, b;
  Comparison comparison;
};

/// Compares the curves of two sessions with `margin_percent`. Default: the smaller margin of both plans, or 10 % if no
/// plan has a margin. Exchanging the arguments inverts the ratios and keeps the verdicts and errors. Sessions with
/// different plates are compared, with a finding that makes the result inconclusive. Errors: `invalid_input` (a session
/// without a curve, trials that both sessions contain, different forms or lapse rates of the fit, different observers
/// or observer parameters), and those of compare().
[[nodiscard]] Result<SessionComparison> compare_sessions(const Session& a, const Session& b,
                                                         std::optional<double> margin_percent);

}  // namespace todbench
