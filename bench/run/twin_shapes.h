// Curves fitted with the functions of their simulated sensor.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "bench/run/experiment_inputs.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// What the simulated sensor is asked without trials, at the contrasts of a curve. `shown_delta_t_k`: what the scene
/// shows of a set contrast, where it is not the same.
[[nodiscard]] DirectEstimateOptions direct_options(const TodCurve& curve, const ExperimentInputs& inputs,
                                                   const std::map<double, double>& shown_delta_t_k, std::uint64_t seed,
                                                   std::stop_token stop);

/// Draws per size of the functions, at least.
inline constexpr int twin_shape_draws = 4000;

/// What became of it, a sentence for each contrast that keeps its Weibull function.
struct TwinShapesOutcome {
  std::vector<std::string> notes;
  std::optional<Error> ended_by;  ///< `interrupted`
};

/// Fits every point of a curve anew with the function of the simulated sensor at its contrast (fit_twin_shape()), from
/// the trials that it was made of. Four thousand draws per size at least: 0.15 to 0.3 %
/// of the threshold, which the interval holds.
[[nodiscard]] TwinShapesOutcome fit_twin_shapes(TodCurve& curve, std::span<const Trial> trials,
                                                const ExperimentInputs& inputs, const FitOptions& fit,
                                                DirectEstimateOptions options);

}  // namespace todbench
