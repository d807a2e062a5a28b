// The modules of a plan and of its sensor in a run: behind the camera, in place of the observer, in its record.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "bench/plan/plan_options.h"
#include "bench/run/devices.h"
#include "bench/run/experiment_inputs.h"
#include "hvs/observer/observer.h"
#include "sim_devices/module/module_plan.h"

namespace todbench {

using ModuleLine = std::function<void(std::string_view line)>;

[[nodiscard]] bool has_modules(const Plan& plan, const SensorSpec& sensor);
/// Success where there is none; `invalid_input`: what follows from sensor and observer alone leaves modules out.
[[nodiscard]] Result<void> refuse_modules(const Plan& plan, const SensorSpec& sensor);

/// In the order of the chain: of the simulated sensor its own, the sensor itself included, then those of the plan; of
/// the camera those of the plan.
[[nodiscard]] std::vector<ModulePlan> picture_modules(const Plan& plan, const SensorSpec& sensor, Side side);
/// Those that are picture to picture, ready for the first one; their errors are those of the run.
[[nodiscard]] std::vector<std::unique_ptr<ChainStage>> module_stages(const std::vector<ModulePlan>& modules,
                                                                     const ModuleLine& on_error_line);
/// What is left out after a change of the target: what one remembers the next remembers again.
[[nodiscard]] int settle_frames(const std::vector<ModulePlan>& modules);
/// Every frame of the bench goes through the modules; what they made of it is judged (ProcessedAs::judged). Without
/// modules nothing changes.
void put_modules_behind(OpenedBench& bench, const std::vector<ModulePlan>& modules, const ModuleLine& on_error_line);

/// The observer of a plan: its templates, or the module in their place.
[[nodiscard]] std::unique_ptr<Observer> observer_of(const Plan& plan, const ExperimentInputs& inputs,
                                                    const ModuleLine& on_error_line);
/// Its name in results.
[[nodiscard]] std::string observer_name(const Plan& plan, const ExperimentInputs& inputs);

/// Command, what its version command says within ten seconds, hashes of the files that the command names.
[[nodiscard]] ModuleRecord module_record(const ModulePlan& module);
/// In words.
[[nodiscard]] std::string text_of(const ModuleRecord& record);
/// Of all modules of a run, the observer last.
[[nodiscard]] std::vector<ModuleRecord> module_records(const Plan& plan, const SensorSpec& sensor, Side side);

}  // namespace todbench
