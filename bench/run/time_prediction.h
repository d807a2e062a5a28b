// How long a plan will take, from the speed of this machine at this moment.
#pragma once

#include <stop_token>

#include "bench/run/experiment_inputs.h"
#include "sim_devices/prediction/effect_planner.h"

namespace todbench {

struct TimePrediction {
  double simulation_s = 0;  ///< of the simulated sensor with its direct estimate, on one core
  double measuring_s = 0;   ///< of what is computed for a camera; its bench comes on top (bench/run/bench_time.h)
};

/// Times each kind of work once on the plan's own sensor, plates and observer (a picture, a frame, a registration, a
/// contrast, the decisions of each plate, a size of the direct estimate of each contrast) and multiplies by how often
/// the plan does it; takes some tenths of a second. Errors: the plate is not found in its own simulated picture, an
/// observer that cannot be prepared; `interrupted`.
[[nodiscard]] Result<TimePrediction> predict_time(const Plan& plan, const ExperimentInputs& inputs,
                                                  std::stop_token stop = {});

/// Draws per size with which the direct estimate will meet the demanded standard error: it is near
/// (0.046 + 0.285 q) / sqrt(draws) of S75. Not capped.
[[nodiscard]] double needed_draws(const Accuracy& accuracy, double q_eff);

}  // namespace todbench
