// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/compare_boresight.h"

#include <fmt/format.h>

#include <algorithm>

#include "bench/cli/commands.h"
#include "bench/cli/session_argument.h"
#include "bench/report/number_format.h"
#include "bench/text/json_fields.h"
#include "tod/camera_measures/boresight.h"

namespace todbench {
namespace {

bool same_triangles(const Session& a, const Session& b) {
  if (a.parts.plates.empty() || b.parts.plates.empty()) return false;
  return std::ranges::equal(a.parts.plates.front().triangles, b.parts.plates.front().triangles,
                            [](const PlateTriangle& one, const PlateTriangle& other) {
                              return one.position_mm == other.position_mm && one.size_mm == other.size_mm &&
                                     one.apex == other.apex;
                            });
}

std::vector<std::string> assumptions(const Boresight& found, bool collimated) {
  std::vector<std::string> sentences{"assumed: the plate did not move between the sessions"};
  if (!collimated) {
    sentences.push_back(fmt::format(
        "assumed: the entrance pupil did not move sideways; a movement of 1 mm would cause {:.3g} mrad of this shift",
        found.sideways_mrad_per_mm));
  }
  return sentences;
}

Json boresight_json(const Boresight& found, const std::vector<std::string>& assumed) {
  const auto json = [](const Estimate& value) {
    return Json{{"value", json_number(value.value)}, {"ci95", json_interval(value.interval())}};
  };
  return {{"shift_x_mrad", json(found.shift_x_mrad)}, {"shift_y_mrad", json(found.shift_y_mrad)},
          {"shift_x_px", json(found.shift_x_px)},     {"shift_y_px", json(found.shift_y_px)},
          {"roll_mrad", json(found.roll_mrad)},       {"distance_m", found.distance_m},
          {"ifov_ratio", found.ifov_ratio},           {"assumptions", assumed}};
}

}  // namespace

int show_boresight(Console& console, const std::array<NamedSession, 2>& sessions, const Opening& opening,
                   const std::vector<std::string>& accepted_files) {
  const auto& [first, second] = sessions;
  for (const NamedSession& one : sessions) {
    const auto& measures = one.session.measures;
    if (!measures || !measures->main || !measures->main->geometry) {
      return report_error(
          console, {ErrorCode::invalid_input, one.folder + ": no geometry was measured ([measures] geometry = true)"});
    }
  }
  if (!same_triangles(first.session, second.session))
    return report_error(console, {ErrorCode::invalid_input, "no boresight: the plates of the sessions differ"});
  const auto found = boresight(*first.session.measures->main->geometry, *second.session.measures->main->geometry);
  if (!found) return report_error(console, with_context(first.folder + ", " + second.folder, found.error()));
  const bool collimated =
      first.session.plan.target.collimator.stated() && second.session.plan.target.collimator.stated();
  const std::vector<std::string> assumed = assumptions(*found, collimated);
  if (console.json()) {
    Json json = boresight_json(*found, assumed);
    add_accepted_changes(json, opening, accepted_files);
    console.object(json);
    return 0;
  }
  const auto row = [](const char* name, const char* unit, const Estimate& value) {
    return TableRow{name, unit, with_interval(value.value, value.interval())};
  };
  console.table(
      {"from " + first.folder + " to " + second.folder, "unit", "value [95 %]"},
      {row("line of sight, to the right", "mrad", found->shift_x_mrad),
       row("line of sight, down", "mrad", found->shift_y_mrad),
       row("line of sight, to the right", "px", found->shift_x_px), row("line of sight, down", "px", found->shift_y_px),
       row("roll, clockwise", "mrad", found->roll_mrad)});
  for (const std::string& sentence : assumed) console.text(sentence);
  return 0;
}

}  // namespace todbench
