// SPDX-License-Identifier: GPL-3.0-or-later
// Values of one measure of one unit in the order of time, for a control chart.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/history/control_chart.h"
#include "bench/history/history_index.h"

namespace todbench {

/// Value that precedes the last event or change of firmware, and therefore is not part of a chart.
struct EarlierValue {
  std::string started_utc;
  ChartValue value;      ///< value on the scale of the chart
  std::string ended_by;  ///< kind of the next event, or "firmware"
};

/// Values of one measure of a unit since its last event and with one firmware.
struct HistorySeries {
  HistoryUnit unit;
  std::string measure, condition, unit_text, scale;
  std::vector<ChartValue> values;  ///< values on the scale of the chart
  std::vector<std::string> started_utc;
  std::vector<EarlierValue> earlier{};
};

/// Treatment of measures that have only earlier values and therefore no chart.
enum class WithoutChart { left_out, listed };

/// Returns the series of a serial number and a measure; an empty text selects all. Errors: those of the index.
[[nodiscard]] Result<std::vector<HistorySeries>> history_series(const HistoryIndex& index, const std::string& serial,
                                                                const std::string& measure,
                                                                WithoutChart without = WithoutChart::left_out);

/// Returns a value of the chart in the unit of the measure.
[[nodiscard]] double shown_value(const HistorySeries& series, double value);

}  // namespace todbench
