// The plan of `todbench simulate`: a file with what the command line says in place of it, or the command line alone.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "bench/plan/plan.h"

namespace todbench {

/// What the command line says; what is not there leaves the plan as it is.
struct SimulationOverrides {
  std::string plan;  ///< name or file; empty: the options alone say what to simulate
  std::optional<std::uint64_t> seed;
  std::optional<std::string> sensor, observer, accuracy;
  std::optional<int> microscan;
  std::optional<double> tolerance_percent;
  std::vector<double> delta_t_k;         ///< empty: those of the plan
  std::vector<std::string> skip, force;  ///< names of effects, beside those of the plan
};

/// The plan with the overrides, checked as a plan file is. Without a plan file the plates stand at a distance that
/// suits the sensor, which takes a draft estimate. Errors: `invalid_input` naming the option, `interrupted`.
[[nodiscard]] Result<Plan> simulation_plan(const SimulationOverrides& overrides, std::stop_token stop);

}  // namespace todbench
