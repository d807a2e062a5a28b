// SPDX-License-Identifier: GPL-3.0-or-later
// TOD curve as lines of text for a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bench/plan/plan.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Input of the lines: acuity 1/S75 at every contrast of the plan with its 95 % interval, acuity of the twin, and
/// limits.
struct CurveLines {
  std::vector<double> delta_t_k;       ///< set contrasts, in this order
  const TodCurve* measured = nullptr;  ///< not owned; null: not yet known
  const TodCurve* twin = nullptr;
  std::vector<AcuityLimit> limits{};
};
/// Returns one heading, and one line per contrast. A line has at most `columns` characters (40 if `columns` is less).
[[nodiscard]] std::vector<std::string> curve_lines(const CurveLines& shown, std::size_t columns);
/// Returns the curve in one line: "16.9 K 0.512 [0.470, 0.559], 1.93 K –".
[[nodiscard]] std::string curve_in_one_line(const CurveLines& shown);

}  // namespace todbench
