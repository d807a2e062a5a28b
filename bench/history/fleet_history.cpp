// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/history/fleet_history.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/plan/key_types.h"
#include "bench/plan/quantity.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

bool is_of(const HistoryUnit& unit, const FleetKind& kind) {
  return unit.model == kind.model && (kind.vendor.empty() || unit.vendor == kind.vendor) &&
         (kind.lens.empty() || unit.lens == kind.lens) &&
         (kind.without_serial.empty() || unit.serial != kind.without_serial);
}

/// Returns 2 for "dT=2K".
std::optional<double> contrast_of(const std::string& condition) {
  constexpr std::string_view before = "dT=";
  if (!condition.starts_with(before) || !condition.ends_with('K')) return std::nullopt;
  return parse_number(condition.substr(before.size(), condition.size() - before.size() - 1));
}

bool can_be_limited(const HistoryValue& value) {
  if (value.measure == fleet_acuity) return contrast_of(value.condition).has_value();
  return value.condition.empty() && find_limited_quantity(value.measure) != nullptr;
}

/// Last value of every unit.
struct LastValues {
  std::map<std::string, UnitValue> by_serial;
  std::string unit_text, scale, first_utc, last_utc;
};

FleetFound found_of(const std::string& measure, const std::string& condition, const LastValues& last,
                    const FleetKind& kind) {
  FleetFound found{.row = {.measure = measure, .delta_t_k = contrast_of(condition)},
                   .unit_text = last.unit_text,
                   .first_utc = last.first_utc,
                   .last_utc = last.last_utc,
                   .refused = {}};
  std::vector<UnitValue> units;
  for (const auto& [serial, value] : last.by_serial) units.push_back(value);
  found.row.units = static_cast<int>(units.size());
  const auto prior = fleet_prior(units);
  if (!prior) {
    found.refused = prior.error().message;
    return found;
  }
  found.row.mean = last.scale == "ln" ? std::exp(prior->mean) : prior->mean;
  found.row.sd = prior->sd;
  found.row.u = prior->u;
  found.row.source = one_line(kind.model) + ", " + std::to_string(found.row.units) + " units, " + last.first_utc +
                     " to " + last.last_utc;
  if (!(found.row.mean > 0)) found.refused = "the mean is not above 0, so a plan cannot state it";
  return found;
}

}  // namespace

Result<std::vector<FleetFound>> fleets_of(const HistoryIndex& index, const FleetKind& kind) {
  TODBENCH_TRY(const auto sessions, index.sessions(std::nullopt));
  std::map<std::pair<std::string, std::string>, LastValues> last;
  std::set<std::string> vendors, lenses;
  for (const HistorySession& session : sessions) {
    // Simulated sessions have no serial number and are no units of a fleet.
    if (!is_of(session.unit, kind) || session.state != "complete" || session.unit.serial.empty()) continue;
    vendors.insert(session.unit.vendor);
    lenses.insert(session.unit.lens);
    for (const HistoryValue& value : session.values) {
      if (!can_be_limited(value)) continue;
      LastValues& of = last[{value.measure, value.condition}];
      of.by_serial[session.unit.serial] = {value.value, value.u};  // sessions of a unit are in the order of time
      of.unit_text = value.unit;
      of.scale = value.scale;
      if (of.first_utc.empty() || session.started_utc < of.first_utc) of.first_utc = session.started_utc;
      of.last_utc = std::max(of.last_utc, session.started_utc);
    }
  }
  if (last.empty())
    return fail(ErrorCode::not_found, one_line(kind.model) + ": the history has no complete session of such a unit");
  if (vendors.size() > 1)
    return fail(ErrorCode::invalid_input,
                one_line(kind.model) + ": the history has units of several vendors, state one with --vendor");
  if (lenses.size() > 1)
    return fail(ErrorCode::invalid_input,
                one_line(kind.model) + ": the history has units with several lenses, state one with --lens");
  std::vector<FleetFound> fleets;
  for (const auto& [name, values] : last) fleets.push_back(found_of(name.first, name.second, values, kind));
  return fleets;
}

std::string fleets_toml(const std::vector<FleetFound>& fleets) {
  std::string toml;
  for (const FleetFound& found : fleets) {
    const FleetRow& row = found.row;
    const std::string contrast = row.delta_t_k ? number_text(*row.delta_t_k) : "";
    if (!found.refused.empty()) {
      toml += "# " + row.measure + (contrast.empty() ? "" : " at " + contrast + " K") + ": " + found.refused + "\n\n";
      continue;
    }
    toml += "[[limits.fleet]]\nmeasure = " + toml_string(row.measure) + "\n";
    if (!contrast.empty()) toml += "delta_t_k = " + contrast + "\n";
    toml += "mean = " + number_text(row.mean) + "\nsd = " + number_text(row.sd) + "\nu = " + number_text(row.u) +
            "\nunits = " + std::to_string(row.units) + "\nsource = " + toml_string(row.source) + "\n\n";
  }
  return toml;
}

}  // namespace todbench
