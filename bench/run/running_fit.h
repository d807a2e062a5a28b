// SPDX-License-Identifier: GPL-3.0-or-later
// Fits answers while they arrive.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <stop_token>
#include <utility>

#include "bench/plan/plan.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Fits the answers that have arrived, with the same function as the result. One thread at a time.
class RunningFit {
 public:
  explicit RunningFit(Plan plan) : plan_(std::move(plan)) {}

  /// Returns the curve without a posterior. The first call computes the functions of the simulated sensor at the set
  /// contrasts, from 1000 draws per size: a second of processor time. Empty: no answers, no curve, or stopped.
  [[nodiscard]] std::optional<TodCurve> curve_of(std::span<const Trial> trials, const std::stop_token& stop);

 private:
  /// Returns whether the functions are complete.
  bool prepare(const std::stop_token& stop);

  Plan plan_;
  std::optional<std::map<double, ProportionTable>> functions_;
};

}  // namespace todbench
