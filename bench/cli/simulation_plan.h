// SPDX-License-Identifier: GPL-3.0-or-later
// Plan of `todbench simulate`: a file with overrides from the command line, or the command line alone.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>

#include "bench/cli/key_options.h"
#include "bench/plan/loaded_plan.h"

namespace todbench {

/// Overrides from the command line. Absent overrides leave the plan unchanged. A sensor also sets its microscan. A
/// tolerance alone also sets the accuracy. Effects to skip or force are added to the lists of the plan.
struct SimulationOverrides {
  std::string plan;  ///< name or file; empty: the options define the simulation
  std::optional<std::uint64_t> seed;
  KeyOverrides keys;
};

/// Returns the plan with the overrides, checked like a plan file. Without a plan file, the distance of the plates is
/// chosen for the sensor by a draft estimate. Errors: `invalid_input` naming the option, `interrupted`.
[[nodiscard]] Result<LoadedPlan> simulation_plan(const SimulationOverrides& overrides, std::stop_token stop);

}  // namespace todbench
