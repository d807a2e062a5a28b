// SPDX-License-Identifier: GPL-3.0-or-later
// A made-up acceptance test with every part of a report filled in.
#pragma once

#include "bench/report/report.h"

namespace todbench {

/// Counts that an observer with this psychometric function (size form, no lapse) gives on average, rounded to whole
/// answers: eight sizes round the threshold, `clusters` presentations of ten trials at each.
[[nodiscard]] std::vector<Level> expected_answers(double threshold_mrad, double slope, int clusters);

/// A point with a threshold, a 95 % interval of +-`relative` and expected answers.
[[nodiscard]] TodPoint sample_point(double set_delta_t_k, double seen_delta_t_k, double threshold_mrad,
                                    double relative);

/// Measured and simulated curve at 16.9, 1.93 and 0.23 K, three limits (met, not decided, not met), comparison, frames,
/// provenance.
[[nodiscard]] ReportData sample_report();

}  // namespace todbench
