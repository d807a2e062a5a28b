// How long a plan will take, from the speed of this machine at this moment.
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include "bench/run/experiment_inputs.h"
#include "sim_devices/prediction/effect_planner.h"

namespace todbench {

struct TimePrediction {
  double simulation_s = 0;              ///< of the simulated sensor with its direct estimate, on one core
  std::optional<double> measurement_s;  ///< of the camera of the plan, without its twin; nothing: it names none
};

/// Times each kind of work once on the plan's own sensor, plates and observer (a picture, a frame, a registration, a
/// contrast, the decisions of each plate, a size of the direct estimate of each contrast) and multiplies by how often
/// the plan does it; takes some tenths of a second. The camera adds what the plan says that changes of the target take
/// and the frames it waits for, at the frame rate of the simulated sensor. Errors: the plate is not found in its own
/// simulated picture, an observer that cannot be prepared; `interrupted`.
[[nodiscard]] Result<TimePrediction> predict_time(const Plan& plan, const ExperimentInputs& inputs,
                                                  const std::vector<ContrastOutlook>& outlooks,
                                                  std::stop_token stop = {});

/// Draws per size with which the direct estimate will meet the demanded standard error: it is near
/// (0.08 + 0.5 q) / sqrt(draws) of S75. Not capped.
[[nodiscard]] double needed_draws(const Accuracy& accuracy, double q_eff);

}  // namespace todbench
