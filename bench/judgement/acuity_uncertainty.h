// SPDX-License-Identifier: GPL-3.0-or-later
// Application of the budget of a plan to a measured curve: intervals that also include sources of uncertainty other
// than the finite number of trials.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/judgement/uncertainty_budget.h"
#include "bench/plan/plan.h"
#include "tod/comparison/comparison.h"
#include "tod/presentation/presentation.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Row of the budget at one contrast. Its sensitivity is d ln acuity / d value, with the value in the unit of the row.
struct AppliedRow {
  BudgetRow row;
  BudgetInput input = BudgetInput::acuity;
  double standard_uncertainty = 0;  ///< standard uncertainty in the unit of the row
  double contribution = 0;          ///< contribution to the uncertainty of ln acuity
  double share_percent = 0;         ///< share of the variance
  bool from_run = false;            ///< added by the run, not stated in the plan
};

/// Intervals of the ratio of the measured acuity to the acuity of the twin. Rows common to camera and twin cancel.
struct ExpandedRatio {
  Interval ci95, ci90;
};

/// Uncertainty at one contrast. Each u is the standard uncertainty of ln acuity. It equals the standard uncertainty of
/// ln S75.
struct PointUncertainty {
  double set_delta_t_k = 0;
  double contrast_slope = 1;  ///< d ln acuity / d ln contrast
  std::vector<AppliedRow> rows;
  Interval statistical_mrad{};  ///< 95 % interval of S75 from the finite number of trials
  /// 95 % interval of S75 from all rows. Each limit is the widest of the GUM, the Monte Carlo and the statistical
  /// interval.
  Interval expanded_mrad{};
  /// Combined uncertainty for the mean of both half-widths; empty if the threshold or a limit of its interval is
  /// missing.
  std::optional<CombinedUncertainty> combined{};
  double u_stated = 0;                   ///< u from all rows except the finite number of trials
  double u_not_twin = 0;                 ///< u from the rows that do not cancel in the ratio to the twin
  double u_not_series = 0;               ///< u from the rows that do not cancel in a trend over a series
  double u_not_contrasts = 0;            ///< u from the rows that do not cancel between contrasts
  std::optional<ExpandedRatio> ratio{};  ///< ratio to the twin; empty without a comparison
};

/// Uncertainty of a curve.
struct CurveUncertainty {
  std::vector<PointUncertainty> points;   ///< uncertainty of each point, in the order of the curve
  std::vector<std::string> not_stated{};  ///< rows of a complete budget that are missing
  /// Relative standard uncertainty of the temperature scale, and of quantities that are divided by it
  /// (relative_u_of_scale()).
  double u_scale = 0;
  double u_camera_scale = 0;  ///< relative standard uncertainty of kelvin on the scale of the camera
  double u_distance = 0;      ///< relative standard uncertainty of an angle per pixel (relative_u_of_distance())
};

/// Returns the point at this set contrast; null if absent.
[[nodiscard]] const PointUncertainty* point_at(const CurveUncertainty& uncertainty, double set_delta_t_k);

/// Returns the interval of S75 in mrad that the decision uses. For a point with a lapse warning, this is the interval
/// that contains the intervals of both fits. Empty if the slope is at its lower bound (the threshold is then
/// meaningless), or if the likelihood has a ridge instead of a maximum.
[[nodiscard]] Interval deciding_interval(const TodPoint& point);

/// Returns the expanded intervals; empty if the plan has no budget. `plan.seed` seeds the Monte Carlo check.
/// `source_loss`: relative loss of contrast by the size-of-source effect at the triangles that measure the contrast;
/// empty: not measured. Errors: those of combined().
[[nodiscard]] Result<std::optional<CurveUncertainty>> curve_uncertainty(const Plan& plan, const TodCurve& curve,
                                                                        std::span<const Presentation> presentations,
                                                                        const std::optional<Comparison>& comparison,
                                                                        const std::optional<double>& source_loss = {});

}  // namespace todbench
