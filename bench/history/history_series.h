// The values of one measure of one unit, in the order of time: what a control chart is made of.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/history/control_chart.h"
#include "bench/history/history_index.h"

namespace todbench {

/// A value from before the last event or change of firmware, in no chart.
struct EarlierValue {
  std::string started_utc;
  ChartValue value;      ///< on the scale of the chart
  std::string ended_by;  ///< kind of the next event, or "firmware"
};

/// Values of one measure of a unit since its last event and with one firmware.
struct HistorySeries {
  HistoryUnit unit;
  std::string measure, condition, unit_text, scale;
  std::vector<ChartValue> values;  ///< on the scale of the chart
  std::vector<std::string> started_utc;
  std::vector<EarlierValue> earlier{};
};

/// Whether measures that have earlier values alone are listed, too.
enum class WithoutChart { left_out, listed };

/// Of a serial number or of all units, of a measure or of all; empty: all. Errors of the index.
[[nodiscard]] Result<std::vector<HistorySeries>> history_series(const HistoryIndex& index, const std::string& serial,
                                                                const std::string& measure,
                                                                WithoutChart without = WithoutChart::left_out);

/// A value of the chart as people know it.
[[nodiscard]] double shown_value(const HistorySeries& series, double value);

}  // namespace todbench
