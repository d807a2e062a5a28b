// The physical measures that a plan asks for, of the camera and of its simulated twin.
#pragma once

#include <optional>
#include <stop_token>

#include "bench/run/devices.h"
#include "bench/run/experiment_inputs.h"
#include "bench/run/meanwhile.h"
#include "bench/run/session_frame.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {

/// With the bench of the trials, after them; `options` are those of the trials, the plates those of `inputs`. What
/// cannot be measured is a reason in the result and a note. Nothing: none is asked for. Fails with `interrupted` only.
[[nodiscard]] Result<std::optional<CameraMeasures>> physical_measures(const Plan& plan,
                                                                      const MeasurementOptions& options,
                                                                      const ExperimentInputs& inputs,
                                                                      OpenedBench& bench, const SessionFrame& frame,
                                                                      std::stop_token stop);

/// The same of the plan's sensor as it is described, with every effect: also with those that the planner leaves out of
/// the trials. Beside its MTF and CTF stand the closed forms.
[[nodiscard]] Result<std::optional<CameraMeasures>> simulated_measures(const LoadedPlan& loaded,
                                                                       const ExperimentInputs& inputs,
                                                                       const SessionFrame& frame, std::stop_token stop);

/// simulated_measures() on a thread of its own: they depend on the plan alone, and a camera that measures leaves
/// processor time. A program in place of the sensor is left alone until its turn comes.
class MeasuresMeanwhile {
 public:
  /// Begins, unless they have to wait; `loaded` and `inputs` outlive it.
  MeasuresMeanwhile(const LoadedPlan& loaded, const ExperimentInputs& inputs);
  /// Waits for them, and says then what there is to say.
  [[nodiscard]] Result<std::optional<CameraMeasures>> take(const SessionFrame& frame, std::stop_token stop);

 private:
  const LoadedPlan& loaded_;
  const ExperimentInputs& inputs_;
  std::optional<Meanwhile<Result<std::optional<CameraMeasures>>>> made_;
};

/// Puts the picture of the plan's sensor beside the mean picture of the plate, where there is one; a reason where they
/// cannot be compared.
void compare_picture(CameraMeasures& measures, const LoadedPlan& loaded, const ExperimentInputs& inputs);

}  // namespace todbench
