// SPDX-License-Identifier: GPL-3.0-or-later
// The physical measures that a plan requests, of the camera and of its simulated twin.
#pragma once

#include <optional>
#include <stop_token>

#include "bench/devices/devices.h"
#include "bench/run/session_end.h"
#include "bench/twin/background_task.h"
#include "bench/twin/experiment_inputs.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {

/// Measures with the bench after the trials. `options` are the options of the trials; the plates come from `inputs`. If
/// a measure is not possible, the result contains the reason, and a note of the session states it. Empty: the plan
/// requests no measures. Errors: `interrupted`.
[[nodiscard]] Result<std::optional<CameraMeasures>> physical_measures(const Plan& plan,
                                                                      const MeasurementOptions& options,
                                                                      const ExperimentInputs& inputs,
                                                                      OpenedBench& bench, const OpenSession& open,
                                                                      std::stop_token stop);

/// Returns the measures of the sensor of the plan as described, with all effects, including those that the planner
/// skips in the trials. Adds the closed forms of its MTF and CTF.
[[nodiscard]] Result<std::optional<CameraMeasures>> simulated_measures(const LoadedPlan& loaded,
                                                                       const ExperimentInputs& inputs,
                                                                       const OpenSession& open, std::stop_token stop);

/// Call of simulated_measures() on its own thread. The measures depend on the plan alone, and the processor is partly
/// idle while the camera measures. With a program in place of the sensor, the call begins at take().
class BackgroundMeasures {
 public:
  /// Starts the thread, unless the sensor is a program. `loaded` and `inputs` outlive this object.
  BackgroundMeasures(const LoadedPlan& loaded, const ExperimentInputs& inputs);
  /// Waits for the measures and emits their notes.
  [[nodiscard]] Result<std::optional<CameraMeasures>> take(const OpenSession& open, std::stop_token stop);

 private:
  const LoadedPlan& loaded_;
  const ExperimentInputs& inputs_;
  std::optional<BackgroundTask<Result<std::optional<CameraMeasures>>>> made_;
};

/// Adds the picture of the plan's sensor to the mean picture of the plate, if any; adds a reason if the two are not
/// comparable.
void compare_picture(CameraMeasures& measures, const LoadedPlan& loaded, const ExperimentInputs& inputs);

}  // namespace todbench
