// From the parameters of a task to what is simulated, and its answer.
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

/// A sweep that can be run: its file read, its parameters known, its base plan loaded.
struct RunnableSweep {
  Sweep sweep;
  LoadedPlan initial;                ///< without any parameter
  std::vector<SweepParameter> base;  ///< those of [base], but for the plan
};
/// Keys are those of a plan by path ("simulation.accuracy"), by the name of the option of `todbench simulate`
/// ("delta_t_k", "observer", "sensor"), those of a sensor ("netd_k"), and "plan" in [base], a name or a file. Without a
/// plan there is no unit under test and the plates stand at a distance that suits each sensor. Every value of every key
/// is checked here, once. `invalid_input` in one sentence.
[[nodiscard]] Result<RunnableSweep> load_sweep(const std::filesystem::path& file);

/// The plan of a task, seed included. Errors: `invalid_input` for values that do not go together.
[[nodiscard]] Result<LoadedPlan> task_plan(const RunnableSweep& runnable, const SweepTask& task, std::stop_token stop);

/// The answer of a task: {"points": [...]}, no times in it. A folder is needed for what a simulation writes on its way.
[[nodiscard]] Result<Json> run_task(const RunnableSweep& runnable, const SweepTask& task,
                                    const std::filesystem::path& scratch, std::stop_token stop);

/// Predicted time of one task on this machine at this moment, in seconds.
[[nodiscard]] Result<double> predicted_task_s(const RunnableSweep& runnable, const SweepTask& task,
                                              std::stop_token stop);

}  // namespace todbench
