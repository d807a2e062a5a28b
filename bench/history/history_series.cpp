#include "bench/history/history_series.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace todbench {
namespace {

std::optional<double> last_break(const std::vector<HistoryEvent>& events) {
  std::optional<double> last;
  for (const HistoryEvent& event : events) {
    if (const auto days = days_of_utc(event.utc)) last = std::max(last.value_or(*days), *days);
  }
  return last;
}

}  // namespace

Result<std::vector<HistorySeries>> history_series(const HistoryIndex& index, const std::string& serial,
                                                  const std::string& measure) {
  const auto sessions = index.sessions(serial.empty() ? std::nullopt : std::optional(serial));
  if (!sessions) return tl::unexpected(sessions.error());
  std::vector<HistorySeries> all;
  std::map<std::string, std::optional<double>> breaks;
  std::string firmware;
  // Sessions come by unit: the series of the unit in hand are the last ones.
  std::optional<HistoryUnit> in_hand;
  std::size_t first = 0;
  for (const HistorySession& session : *sessions) {
    const HistoryUnit& unit = session.unit;
    if (in_hand != unit) {
      in_hand = unit;
      first = all.size();
      firmware.clear();
    }
    const auto begin = [&] { return all.begin() + static_cast<std::ptrdiff_t>(first); };
    if (!breaks.contains(unit.serial)) {
      const auto events = index.events(unit.serial);
      if (!events) return tl::unexpected(events.error());
      breaks[unit.serial] = last_break(*events);
    }
    const double days = days_of_utc(session.started_utc).value_or(0);
    if (breaks[unit.serial] && days < *breaks[unit.serial]) continue;
    // Another firmware begins a new series.
    if (!firmware.empty() && firmware != session.firmware) all.erase(begin(), all.end());
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
  return all;
}

double shown_value(const HistorySeries& series, double value) {
  return series.scale == "ln" ? std::exp(value) : value;
}

}  // namespace todbench
