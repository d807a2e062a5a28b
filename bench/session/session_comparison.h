// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison of two sessions: precondition checks and result.
#pragma once

#include <optional>

#include "bench/session/session_folder.h"

namespace todbench {

/// Compared curves; tested for adequacy if their session stored no findings.
struct SessionComparison {
  TodCurve a, b;
  Comparison comparison;
};

/// Compares the curves of two sessions with `margin_percent`; by default with the smaller margin of their plans, 10 %
/// if neither has one. Exchanged arguments give inverse ratios and the same verdicts and errors. Sessions with
/// different plates are compared, with a finding that makes the result inconclusive. Errors: `invalid_input`, one
/// sentence (a session without a curve, shared trials, another form or lapse rate of the fit, another observer or other
/// observer parameters), and those of compare().
[[nodiscard]] Result<SessionComparison> compare_sessions(const Session& a, const Session& b,
                                                         std::optional<double> margin_percent);

}  // namespace todbench
