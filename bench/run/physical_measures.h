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

/// Takes the physical measures on the bench after the trials. `options` are the options of the trials; the plates come
/// from `inputs`. If a measure is not possible, the result contains the reason, and a note of the session states it.
/// Empty: the plan requests no measures. Errors: `interrupted`.
[[nodiscard]] Result<std::optional<CameraMeasures>> physical_measures(const Plan& plan,
                                                                      const MeasurementOptions& options,
                                                                      const ExperimentInputs& inputs,
                                                                      OpenedBench& bench, const OpenSession& open,
                                                                      std::stop_token stop);

/// Returns the measures of the sensor of the plan. All effects of its description are simulated, including those that
/// the planner skips in the trials. Adds the closed forms of its MTF and CTF.
[[nodiscard]] Result<std::optional<CameraMeasures>> simulated_measures(const LoadedPlan& loaded,
                                                                       const ExperimentInputs& inputs,
                                                                       const OpenSession& open, std::stop_token stop);

/// Calls simulated_measures() on its own thread, because the measures depend only on the plan and the processor is
/// partly idle while the camera measures. If a program replaces the sensor, the call begins in take().
class BackgroundMeasures {
 public:
  /// Starts the thread, unless the sensor is a program. `loaded` and `inputs` must outlive this object.
  BackgroundMeasures(const LoadedPlan& loaded, const ExperimentInputs& inputs);
  /// Waits for the measures and emits their notes.
  [[nodiscard]] Result<std::optional<CameraMeasures>> take(const OpenSession& open, std::stop_token stop);

 private:
  const LoadedPlan& loaded_;
  const ExperimentInputs& inputs_;
  std::optional<BackgroundTask<Result<std::optional<CameraMeasures>>>> made_;
};

/// Adds the picture of the plan's sensor to the mean picture of the plate, if there is one. Adds a reason if the two
/// pictures are not comparable.
void compare_picture(CameraMeasures& measures, const LoadedPlan& loaded, const ExperimentInputs& inputs);

}  // namespace todbench
