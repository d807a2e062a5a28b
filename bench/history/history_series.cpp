// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/history/history_series.h"

#include "acquisition/base/try.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace todbench {
namespace {

struct Break {
  double days = 0;
  std::string kind;
};

/// Returns the breaks in the order of time.
std::vector<Break> breaks_of(const std::vector<HistoryEvent>& events) {
  std::vector<Break> breaks;
  for (const HistoryEvent& event : events) {
    if (const auto days = days_of_utc(event.utc)) breaks.push_back({*days, event.kind});
  }
  std::ranges::stable_sort(breaks, {}, &Break::days);
  return breaks;
}

void end_values(HistorySeries& series, const std::string& by) {
  for (std::size_t i = 0; i < series.values.size(); ++i)
    series.earlier.push_back({series.started_utc[i], series.values[i], by});
  series.values.clear(), series.started_utc.clear();
}

}  // namespace

Result<std::vector<HistorySeries>> history_series(const HistoryIndex& index, const std::string& serial,
                                                  const std::string& measure, WithoutChart without) {
  TODBENCH_TRY(const auto sessions, index.sessions(serial.empty() ? std::nullopt : std::optional(serial)));
  std::vector<HistorySeries> all;
  std::map<std::string, std::vector<Break>> breaks;
  std::string firmware;
  // Sessions are ordered by unit and time: the series of the current unit are the last ones.
  std::optional<HistoryUnit> in_hand;
  std::size_t first = 0, passed = 0;  // breaks of the unit
  for (const HistorySession& session : sessions) {
    const HistoryUnit& unit = session.unit;
    if (in_hand != unit) {
      in_hand = unit;
      first = all.size(), passed = 0;
      firmware.clear();
    }
    const auto begin = [&] { return all.begin() + static_cast<std::ptrdiff_t>(first); };
    const auto end_all = [&](const std::string& by) {
      std::for_each(begin(), all.end(), [&](HistorySeries& series) { end_values(series, by); });
    };
    if (!breaks.contains(unit.serial)) {
      TODBENCH_TRY(const auto events, index.events(unit.serial));
      breaks[unit.serial] = breaks_of(events);
    }
    const double days = days_of_utc(session.started_utc).value_or(0);
    for (const std::vector<Break>& of_unit = breaks[unit.serial];
         passed < of_unit.size() && of_unit[passed].days <= days; ++passed)
      end_all(of_unit[passed].kind);
    if (!firmware.empty() && firmware != session.firmware) end_all("firmware");
    firmware = session.firmware;
    for (const HistoryValue& value : session.values) {
      if (!measure.empty() && value.measure != measure) continue;
      auto found = std::find_if(begin(), all.end(), [&](const HistorySeries& series) {
        return series.measure == value.measure && series.condition == value.condition;
      });
      if (found == all.end())
        found = all.insert(all.end(), {unit, value.measure, value.condition, value.unit, value.scale, {}, {}});
      found->values.push_back({days, value.value, value.u});
      found->started_utc.push_back(session.started_utc);
    }
  }
  // An event after the last session ends its series.
  for (HistorySeries& series : all) {
    for (const Break& one : breaks[series.unit.serial])
      if (!series.values.empty() && series.values.back().days < one.days) end_values(series, one.kind);
  }
  if (without == WithoutChart::left_out)
    std::erase_if(all, [](const HistorySeries& series) { return series.values.empty(); });
  return all;
}

double shown_value(const HistorySeries& series, double value) {
  return series.scale == "ln" ? std::exp(value) : value;
}

}  // namespace todbench
