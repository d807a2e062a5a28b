// The budget of a plan applied to a measured curve: intervals that hold more than the finite number of trials.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/judgement/uncertainty_budget.h"
#include "bench/plan/plan.h"
#include "tod/comparison/comparison.h"
#include "tod/presentation/presentation.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// A row of the budget at one contrast; its sensitivity is that of ln acuity to the value as it is stated.
struct AppliedRow {
  BudgetRow row;
  BudgetInput input = BudgetInput::acuity;
  double standard_uncertainty = 0;  ///< in the row's unit
  double contribution = 0;          ///< to ln acuity
  double share_percent = 0;         ///< of the variance
  bool from_run = false;            ///< stated by the run, not by the plan
};

/// A ratio of acuities, measured over twin: rows common to both cancel.
struct ExpandedRatio {
  Interval ci95, ci90;
};

/// One contrast. u is of ln acuity, which is that of ln S75.
struct PointUncertainty {
  double set_delta_t_k = 0;
  double contrast_slope = 1;  ///< d ln acuity / d ln contrast
  std::vector<AppliedRow> rows;
  Interval statistical_mrad{};  ///< 95 % of S75, of the finite number of trials
  Interval expanded_mrad{};     ///< 95 % of S75, of all rows; each side the largest of GUM, Monte Carlo and statistical
  /// Of both sides' mean; nothing where the threshold or a side of its interval is missing.
  std::optional<CombinedUncertainty> combined{};
  double u_stated = 0;      ///< of the rows but the finite trials
  double u_not_twin = 0;    ///< of those that do not cancel in a ratio to the twin
  double u_not_series = 0;  ///< in a trend over a series
  double u_not_contrasts = 0;
  std::optional<ExpandedRatio> ratio{};  ///< to the twin, where there is a comparison
};

struct CurveUncertainty {
  std::vector<PointUncertainty> points;   ///< in the order of the curve
  std::vector<std::string> not_stated{};  ///< rows that a complete budget has
  double u_scale = 0;         ///< relative, of the temperature scale and what is divided by it (relative_u_of_scale())
  double u_camera_scale = 0;  ///< relative, of kelvin of the camera's scale
  double u_distance = 0;      ///< relative, of an angle per pixel (relative_u_of_distance())
};

/// The point at this set contrast; null where there is none.
[[nodiscard]] const PointUncertainty* point_at(const CurveUncertainty& uncertainty, double set_delta_t_k);

/// The interval of S75 in mrad that decides: of a point with a lapse warning both fits have to agree. A slope at its
/// lower bound makes any threshold number meaningless, and a ridge has no point: no interval then.
[[nodiscard]] Interval deciding_interval(const TodPoint& point);

/// Nothing where the plan states no budget. The seed makes the draws of the Monte Carlo check. Errors: combined().
[[nodiscard]] Result<std::optional<CurveUncertainty>> curve_uncertainty(const Plan& plan, const TodCurve& curve,
                                                                        std::span<const Presentation> presentations,
                                                                        const std::optional<Comparison>& comparison);

}  // namespace todbench
