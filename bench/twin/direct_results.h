// SPDX-License-Identifier: GPL-3.0-or-later
// 75 % sizes of a simulated curve, estimated without trials.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "bench/twin/experiment_inputs.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// S75 without trials for the contrasts of a curve. A contrast without an estimate has a note.
struct DirectResults {
  std::map<double, DirectPoint> points;  ///< by contrast
  /// S75 in pitches over the range of the observer's open parameters (open_parameters.h), by contrast.
  std::map<double, std::pair<double, double>> spread_pitch;
  std::vector<std::string> notes;
  std::optional<Error> ended_by;
};

/// Computes the estimates. `shown_delta_t_k`: contrast that the scene shows for a set contrast, if different.
[[nodiscard]] DirectResults direct_results(const TodCurve& curve, const ExperimentInputs& inputs,
                                           const std::map<double, double>& shown_delta_t_k, std::uint64_t seed,
                                           std::stop_token stop);

/// Writes estimates and spreads into the points of the curve.
void keep_direct(const DirectResults& direct, double pitch_mrad, TodCurve& curve);

/// Replaces the thresholds of the planner's analytic estimate (CuedEstimate) by direct estimates, because the analytic
/// thresholds are up to 6 % too low if noise limits the acuity. The estimates have a standard error of 0.4 %, or the
/// usual number of draws if 0.4 % needs too many draws. A contrast without an estimate keeps its threshold. Errors:
/// `interrupted`.
[[nodiscard]] Result<void> refine_thresholds(ExperimentInputs& inputs, std::uint64_t seed, std::stop_token stop);

}  // namespace todbench
