// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison of a ramp with settled contrasts: bench time and half-width.
#pragma once

#include <limits>
#include <optional>
#include <string>

#include "bench/plan/plan.h"
#include "bench/twin/experiment_inputs.h"

namespace todbench {

/// Settling band whose intervals are studied, in percent of the contrast.
inline constexpr double studied_band_percent = 10;

/// Returns the largest rate of a ramp at `from_k`, in K/s, at which a lag of the plate changes the contrast between
/// large and small triangles by at most 0.6 %: S75 then changes by 0.3 % (a ramp at 0.23 K). Infinite without a lag.
[[nodiscard]] double largest_ramp_rate(double from_k, double lag_s);

/// Time and precision of one way to measure the contrasts of a plan.
struct ContrastWay {
  double bench_s = 0;                          ///< bench_time()
  std::optional<double> half_width_percent{};  ///< the largest of the contrasts, which 19 of 20 runs do not exceed
};

/// The ways to measure the contrasts of a plan of kind ramp.
struct RampComparison {
  double lag_s = 0;
  double rate_k_per_s = 0, largest_rate_k_per_s = std::numeric_limits<double>::infinity();
  ContrastWay ramp{};                       ///< ramp at the rate of the plan
  std::optional<ContrastWay> at_largest{};  ///< ramp at the largest rate, if there is one
  ContrastWay settled{}, within_band{};     ///< settled contrasts, and contrasts within studied_band_percent, with the
                                            ///< phases of the plan
};

/// Compares a ramp with settled contrasts; empty for other plans. Errors: those of predict_plan().
[[nodiscard]] Result<std::optional<RampComparison>> compare_ramp(const Plan& plan, const ExperimentInputs& inputs);

/// Returns a sentence if settled contrasts are as fast as the ramp of a plan, or if the rate of the ramp is too high
/// for the lag of the plate; otherwise, or without a prediction, an empty text.
[[nodiscard]] std::string ramp_advice(const Plan& plan, const ExperimentInputs& inputs);

}  // namespace todbench
