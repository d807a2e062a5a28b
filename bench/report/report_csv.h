// The report as a table, for programs.
#pragma once

#include <string>

#include "bench/report/report.h"

namespace todbench {

/// report.csv: one row per number or text of the report, in the order of the page. The columns are
///   section    what it is about: "session", "verdict", "demand", "measured", "simulated", "human", "comparison",
///   "frames" name       of the number, with its unit: "s75_mrad" set_delta_t_k  contrast, where there is one value,
///   low, high  with the 95 % interval, or that of `interval_percent`; empty: there is none interval_percent limit of a
///   demand, in the unit of its value unit       of value, interval and limit; empty for texts and counts decision
///   "pass" ...: of a demand or of the whole; of a threshold the verdict of its fit text       a sentence, or the value
///   of what is no number
/// A session whose files were changed gives no verdict, as its page. A pure function.
[[nodiscard]] std::string report_csv(const ReportData& data);

}  // namespace todbench
