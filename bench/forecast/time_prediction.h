// SPDX-License-Identifier: GPL-3.0-or-later
// Prediction of the computing time of a plan from the present speed of this computer.
#pragma once

#include <stop_token>

#include "bench/twin/experiment_inputs.h"
#include "sim_devices/prediction/effect_planner.h"

namespace todbench {

/// Computing times of a plan.
struct TimePrediction {
  double simulation_s = 0;  ///< computing time of the simulated sensor with its direct estimate, on one core
  double measuring_s = 0;   ///< computing time for a camera, without bench time (bench/forecast/bench_time.h)
};

/// Measures the time of each kind of work once: a picture, a frame, a registration, a contrast, the decisions of each
/// plate, and one size of the direct estimate at each contrast. Each time is multiplied by its number of repetitions in
/// the plan. Takes a few tenths of a second. Errors: the plate is not found in its own simulated picture; the observer
/// cannot be prepared; `interrupted`.
[[nodiscard]] Result<TimePrediction> predict_time(const Plan& plan, const ExperimentInputs& inputs,
                                                  std::stop_token stop = {});

/// Predicts the computing time of the direct estimate alone, in s. Errors: an observer that cannot be prepared;
/// `interrupted`.
[[nodiscard]] Result<double> predict_estimate_s(const ExperimentInputs& inputs, std::stop_token stop);

/// Returns the draws per size at which the relative standard error of S75, about (0.046 + 0.285 `q_eff`) / sqrt(draws),
/// meets the request of `accuracy` (`q_eff`: see ContrastOutlook). At least Accuracy::noise_draws; no upper limit.
[[nodiscard]] double needed_draws(const Accuracy& accuracy, double q_eff);

}  // namespace todbench
