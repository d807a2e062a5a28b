// What the units of one kind in the history say of the next one.
#pragma once

#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/history/history_index.h"
#include "bench/judgement/fleet_prior.h"

namespace todbench {

/// Units of which. Empty: any, but then all of them have to be of one vendor and lens.
struct FleetKind {
  std::string vendor{}, model{}, lens{};
  std::string without_serial{};  ///< the unit that is to be judged says nothing of itself
};

/// A row of a plan, or the sentence why there is none.
struct FleetFound {
  FleetRow row;
  std::string unit_text;
  std::string first_utc, last_utc;  ///< of its sessions
  std::string refused;              ///< empty: the row can be used
};

/// One for every measure that can be limited and for the acuity at every contrast. Each unit counts once, with its last
/// complete session. `not_found`: no such unit; `invalid_input`: units of several vendors or lenses; errors of the
/// index.
[[nodiscard]] Result<std::vector<FleetFound>> fleets_of(const HistoryIndex& index, const FleetKind& kind);

/// Rows of [[limits.fleet]]; those that were refused as comments.
[[nodiscard]] std::string fleets_toml(const std::vector<FleetFound>& fleets);

}  // namespace todbench
