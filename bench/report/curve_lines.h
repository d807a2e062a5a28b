// The TOD curve as lines of text, for a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bench/plan/plan.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// What the lines show: acuity 1/S75 of every contrast of the plan, its 95 % interval, the twin's, and the limit.
struct CurveLines {
  std::vector<double> delta_t_k;       ///< set contrasts, in this order
  const TodCurve* measured = nullptr;  ///< borrowed; null: nothing yet
  const TodCurve* twin = nullptr;
  std::vector<AcuityLimit> limits{};
};
/// A heading and a line for each contrast, each of at most `columns` letters (40 at least are used).
[[nodiscard]] std::vector<std::string> curve_lines(const CurveLines& shown, std::size_t columns);
/// The same in one line: "16.9 K 0.512 [0.470, 0.559], 1.93 K –".
[[nodiscard]] std::string curve_in_one_line(const CurveLines& shown);

}  // namespace todbench
