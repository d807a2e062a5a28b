// SPDX-License-Identifier: GPL-3.0-or-later
// Modules of a plan and of its sensor in a run: after the camera, in place of the observer, in the record.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "bench/devices/devices.h"
#include "bench/plan/plan_options.h"
#include "bench/twin/experiment_inputs.h"
#include "hvs/observer/observer.h"
#include "sim_devices/module/module_plan.h"
#include "tod/measurement/measurement.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Receives lines of the standard error of modules.
using ModuleLine = std::function<void(std::string_view line)>;

/// Returns whether the plan or its sensor has modules.
[[nodiscard]] bool has_modules(const Plan& plan, const SensorSpec& sensor);
/// Succeeds if there are no modules; otherwise `invalid_input`, because the calculation uses sensor and observer alone.
[[nodiscard]] Result<void> refuse_modules(const Plan& plan, const SensorSpec& sensor);

/// Returns the modules in the order of the chain. The simulated sensor has its own modules, including a program in
/// place of the sensor, and then the modules of the plan. The camera has the modules of the plan.
[[nodiscard]] std::vector<ModulePlan> picture_modules(const Plan& plan, const SensorSpec& sensor, Side side);
/// Returns the modules that map a picture to a picture, ready for the first picture; their errors occur during the run.
[[nodiscard]] std::vector<std::unique_ptr<ChainStage>> module_stages(const std::vector<ModulePlan>& modules,
                                                                     const ModuleLine& on_error_line);
/// Returns the number of frames to discard after a change of the target. The numbers of frames that successive modules
/// store add up.
[[nodiscard]] int settle_frames(const std::vector<ModulePlan>& modules);
/// Passes every frame of the bench through the stages; their output is judged (ProcessedAs::judged). Without stages the
/// bench is unchanged.
void put_stages_behind(OpenedBench& bench, std::vector<std::unique_ptr<ChainStage>> stages);

/// Stores the noise of the run in counts and its correlation in every point. With stages after the camera, the stored
/// value is the lower of the noise of the camera's pictures and the noise of the judged pictures at this contrast.
void keep_noise(const MeasurementResult& result, TodCurve& curve);

/// Returns the module that replaces the templates of the observer; null without one.
[[nodiscard]] const ModulePlan* observer_module(const Plan& plan);
/// Creates the observer of a plan: its templates, or the module that replaces them.
[[nodiscard]] std::unique_ptr<Observer> observer_of(const Plan& plan, const ExperimentInputs& inputs,
                                                    const ModuleLine& on_error_line);
/// Returns the name of the observer in results.
[[nodiscard]] std::string observer_name(const Plan& plan, const ExperimentInputs& inputs);

/// Returns the command, the output of its version command (10 s at most), and hashes of the files that it names.
[[nodiscard]] ModuleRecord module_record(const ModulePlan& module);
/// Returns the record as text.
[[nodiscard]] std::string text_of(const ModuleRecord& record);
/// Returns the records of all modules of a run, the observer last.
[[nodiscard]] std::vector<ModuleRecord> module_records(const Plan& plan, const SensorSpec& sensor, Side side);

}  // namespace todbench
