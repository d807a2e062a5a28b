// The plan of `todbench simulate`: a file with what the command line says in place of it, or the command line alone.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>

#include "bench/cli/key_options.h"
#include "bench/plan/loaded_plan.h"

namespace todbench {

/// What the command line says; what is not there leaves the plan as it is. A sensor brings its own microscan, a
/// tolerance alone the accuracy for it, and effects to skip or force come beside those of the plan.
struct SimulationOverrides {
  std::string plan;  ///< name or file; empty: the options alone say what to simulate
  std::optional<std::uint64_t> seed;
  KeyOverrides keys;
};

/// The plan with the overrides, checked as a plan file is. Without a plan file the plates stand at a distance that
/// suits the sensor, which takes a draft estimate. Errors: `invalid_input` naming the option, `interrupted`.
[[nodiscard]] Result<LoadedPlan> simulation_plan(const SimulationOverrides& overrides, std::stop_token stop);

}  // namespace todbench
