// What a plan will cost and how sure its result will be, before it is run.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <vector>

#include "bench/session/plan.h"
#include "tod/tod_curve.h"

namespace todbench {

/// The psychometric function that the simulated sensor of a plan lets expect at a contrast.
struct ExpectedThreshold {
  double delta_t_k = 0;
  std::optional<double> s75_mrad;  ///< nothing: no size has a threshold at this contrast
  double slope = 2.5;              ///< Weibull
  /// Of ln S75 for one presentation of every plate of the plan; it falls with the root of their number. Nothing where
  /// the sizes on the plates do not determine it.
  std::optional<double> se_ln_once;
};

/// By the direct estimate at draft accuracy: a second or so. Errors: as the loaders; `interrupted`.
[[nodiscard]] Result<std::vector<ExpectedThreshold>> expected_thresholds(const Plan& plan, std::stop_token stop);
/// The same as a curve without intervals.
[[nodiscard]] TodCurve as_curve(const std::vector<ExpectedThreshold>& expected);

struct PlannedContrast {
  double delta_t_k = 0;
  std::optional<double> s75_mrad;
  std::optional<double> uncertainty_percent;  ///< half width of the 95 % interval of S75, relative
};

struct PlanOutlook {
  std::uint64_t presentations = 0, trials = 0;
  double duration_s = 0;  ///< of the measurement: changes of the target and frames; without the twin
  std::vector<PlannedContrast> contrasts;
  /// The largest of the contrasts; nothing when one has no threshold.
  [[nodiscard]] std::optional<double> uncertainty_percent() const;
};

/// Cheap enough to follow a slider. Uncertainty of expected_fit(), widened by what clustered trials typically add.
[[nodiscard]] PlanOutlook outlook(const Plan& plan, const std::vector<TargetPlate>& plates,
                                  const std::vector<ExpectedThreshold>& expected, double frame_rate_hz);

/// The least number of phases, 2 to 256, at which every contrast that has a threshold is as sure as
/// `tolerance_percent`.
[[nodiscard]] int phases_for(Plan plan, const std::vector<TargetPlate>& plates,
                             const std::vector<ExpectedThreshold>& expected, double tolerance_percent);

}  // namespace todbench
