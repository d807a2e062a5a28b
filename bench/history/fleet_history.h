// SPDX-License-Identifier: GPL-3.0-or-later
// Fleet prior from the units of one kind in the history.
#pragma once

#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/history/history_index.h"
#include "bench/judgement/fleet_prior.h"

namespace todbench {

/// Selection of units. Empty members match all units. The selected units must share vendor and lens.
struct FleetKind {
  std::string vendor{}, model{}, lens{};
  std::string without_serial{};  ///< serial number of the unit to be judged, whose own sessions are left out
};

/// Row of the fleet for a plan, or the reason for its rejection.
struct FleetFound {
  FleetRow row;
  std::string unit_text;
  std::string first_utc, last_utc;  ///< times of the first and last session of the units
  std::string refused;              ///< reason for rejection, a sentence; empty: usable
};

/// Returns one row for every measure that can have a limit and for the acuity at every contrast. Each unit counts once,
/// with its last complete session. Errors: `not_found` (no such unit), `invalid_input` (units of several vendors or
/// lenses), and those of the index.
[[nodiscard]] Result<std::vector<FleetFound>> fleets_of(const HistoryIndex& index, const FleetKind& kind);

/// Returns the rows of [[limits.fleet]] as TOML; rejected rows are comments.
[[nodiscard]] std::string fleets_toml(const std::vector<FleetFound>& fleets);

}  // namespace todbench
