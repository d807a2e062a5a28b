// The sizes at 75 % of a simulated curve without trials.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "bench/run/experiment_inputs.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// The contrasts of a curve that have one, as their size at 75 % without trials; what has none is a note.
struct DirectResults {
  std::map<double, DirectPoint> points;  ///< by contrast
  std::vector<std::string> notes;
  std::optional<Error> ended_by;
};

/// `shown_delta_t_k`: what the scene shows of a set contrast, where it is not the same.
[[nodiscard]] DirectResults direct_results(const TodCurve& curve, const ExperimentInputs& inputs,
                                           const std::map<double, double>& shown_delta_t_k, std::uint64_t seed,
                                           std::stop_token stop);

}  // namespace todbench
