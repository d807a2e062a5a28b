// SPDX-License-Identifier: GPL-3.0-or-later
// Report as a table for programs.
#pragma once

#include <string>

#include "bench/report/report.h"

namespace todbench {

/// Returns report.csv: one row per number or text of the report, in the order of the page. If files of the session were
/// changed, the decision is "none" and there are no demands, as on the page. A pure function. Columns:
/// | section          | "session", "verdict", "demand", "measured", "simulated", "human", "measures", "measures_twin",
/// |                  | "comparison", "frames", "uncertainty"
/// | name             | name of the number, with its unit: "s75_mrad"
/// | set_delta_t_k    | set contrast, if there is one
/// | value            | the number, if there is one
/// | low, high        | limits of its interval; empty: absent or open
/// | interval_percent | confidence of the interval; empty: no interval
/// | limit            | limit of a demand, in the unit of its value
/// | unit             | unit of value, interval and limit; empty for texts, counts and ratios
/// | decision         | decision ("pass" ...) of a demand or the verdict; for a threshold the verdict of its fit
/// | text             | sentence, or a value that is not a number
/// | definition       | definition of a physical measure
[[nodiscard]] std::string report_csv(const ReportData& data);

}  // namespace todbench
