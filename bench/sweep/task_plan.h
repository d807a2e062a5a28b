// SPDX-License-Identifier: GPL-3.0-or-later
// Conversion of the parameters of a task to a plan, and computation of its result.
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "bench/plan/loaded_plan.h"
#include "bench/sweep/sweep.h"
#include "bench/text/json.h"

namespace todbench {

/// Sweep that is ready to run: its file is read, its parameters are checked, and its base plan is loaded.
struct RunnableSweep {
  Sweep sweep;
  LoadedPlan initial;                ///< base plan without parameters
  std::vector<SweepParameter> base;  ///< parameters of [base], except the plan
};
/// Loads a sweep. A sweep can set the keys of a plan, by path ("simulation.accuracy") or by the option of `todbench
/// simulate` ("delta_t_k", "observer", "sensor"), and the keys of a sensor ("netd_k"). [base] can also set "plan" to a
/// name or a file. Without a plan there is no unit under test, and the distance of the plates is chosen for each
/// sensor. This function checks all values of all keys. Errors: `invalid_input`.
[[nodiscard]] Result<RunnableSweep> load_sweep(const std::filesystem::path& file);

/// Returns the plan of a task, including its seed. Errors: `invalid_input` for values that do not fit together.
[[nodiscard]] Result<LoadedPlan> task_plan(const RunnableSweep& runnable, const SweepTask& task, std::stop_token stop);

/// Returns the result of a task: {"points": [...]}, without times. `scratch`: folder for the files of a simulation.
[[nodiscard]] Result<Json> run_task(const RunnableSweep& runnable, const SweepTask& task,
                                    const std::filesystem::path& scratch, std::stop_token stop);

/// Predicts the time of one task on this computer under its present load, in seconds.
[[nodiscard]] Result<double> predicted_task_s(const RunnableSweep& runnable, const SweepTask& task,
                                              std::stop_token stop);

}  // namespace todbench
