// Answers fitted while they come in.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <stop_token>
#include <utility>

#include "bench/plan/plan.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// The curve of the answers so far, with the function that the result will be fitted with. Not for two threads at once.
class RunningFit {
 public:
  explicit RunningFit(Plan plan) : plan_(std::move(plan)) {}

  /// Without posterior. The first one computes the functions of the simulated sensor at the set contrasts, from 1000
  /// draws per size: a second of processor time. Nothing: no answers, none that make a curve, or stopped.
  [[nodiscard]] std::optional<TodCurve> curve_of(std::span<const Trial> trials, const std::stop_token& stop);

 private:
  /// Whether it is done.
  bool prepare(const std::stop_token& stop);

  Plan plan_;
  std::optional<std::map<double, ProportionTable>> functions_;
};

}  // namespace todbench
