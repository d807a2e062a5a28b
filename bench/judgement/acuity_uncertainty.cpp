// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/judgement/acuity_uncertainty.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "acquisition/base/distributions.h"
#include "acquisition/base/try.h"
#include "bench/plan/bench_air.h"
#include "bench/plan/joined_uncertainty.h"
#include "tod/psychometric/contrast_slope.h"

namespace todbench {
namespace {

constexpr double upper_tail = 0.025;

/// Returns the smallest interval that contains both; an open end stays open.
Interval hull_of(const Interval& a, const Interval& b) {
  Interval both;
  if (a.low && b.low) both.low = std::min(*a.low, *b.low);
  if (a.high && b.high) both.high = std::max(*a.high, *b.high);
  return both;
}

/// Returns the mean of effective contrast minus target read-back times air transmittance at a set contrast; empty
/// without data.
std::optional<double> read_back_deviation_k(std::span<const Presentation> presentations, double set_delta_t_k) {
  double sum = 0;
  int count = 0;
  for (const Presentation& shown : presentations) {
    // A contrast that has not settled is known from the frames alone.
    if (shown.set.wait != ContrastWait::settled) continue;
    if (!same_contrast(shown.set.delta_t_k, set_delta_t_k) || !shown.delta_t_k) continue;
    const double deviation = *shown.delta_t_k - shown.air_transmittance.value_or(1) * shown.said.state.delta_t_k;
    if (!std::isfinite(deviation)) continue;
    sum += deviation;
    ++count;
  }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

/// Returns the air transmittance of the bench, equal for all presentations of a run; empty if not stated.
std::optional<double> air_of(const Plan& plan, std::span<const Presentation> presentations) {
  if (presentations.empty() || !presentations.front().air_transmittance) return std::nullopt;
  const CollimatorPlan& collimator = plan.target.collimator;
  if (!collimator.stated()) return presentations.front().air_transmittance;
  if (!(plan.target.air_humidity_percent > 0)) return std::nullopt;
  return *presentations.front().air_transmittance / collimator.transmission;
}

/// Returns a row for the uncertainty of the air transmittance, unless the plan has one.
std::optional<BudgetRow> row_of_air(const Plan& plan, std::span<const Presentation> presentations) {
  const auto transmittance = air_of(plan, presentations);
  const bool stated = std::any_of(plan.uncertainty.rows.begin(), plan.uncertainty.rows.end(),
                                  [](const BudgetRow& row) { return input_of(row) == BudgetInput::air_path; });
  if (!transmittance || stated) return std::nullopt;
  return BudgetRow{.name = std::string(air_path_row),
                   .value = bench_air_relative_half_width * (1 - *transmittance),
                   .distribution = BudgetDistribution::rectangular,
                   .unit = "1",
                   .source = "half of the attenuation by air in the shipped tables",
                   .enters = BudgetInput::air_path};
}

/// Returns a row for the light that the camera scatters away from the triangles that measure its contrast.
BudgetRow row_of_source(double loss) {
  return {.name = std::string(source_loss_row),
          .value = std::abs(loss),
          .distribution = BudgetDistribution::rectangular,
          .unit = "1",
          .source =
              "measured loss of a source as small as the triangles that measure the contrast, beyond that of the "
              "twin",
          .enters = BudgetInput::contrast};
}

/// Values for the conversion of the rows at a point.
struct Conversion {
  double distance_m = 0;
  double size_m = 0;  ///< of the triangle at the threshold, on the plate
  double contrast_k = 0;
  double slope = 0;
};

/// Returns d ln acuity / d value in the unit of the row.
double sensitivity_of(const BudgetRow& row, const Conversion& at) {
  if (row.sensitivity) return *row.sensitivity;
  const BudgetInput input = input_of(row);
  const InputKind kind = kind_of(input);
  const BudgetUnit unit = budget_unit(kind, row.unit).value_or(BudgetUnit{});
  if (kind == InputKind::contrast) return at.slope * (unit.relative ? unit.factor : unit.factor / at.contrast_k);
  if (kind == InputKind::direct || unit.relative) return unit.factor;
  return unit.factor / (input == BudgetInput::cut_outs ? at.size_m : at.distance_m);
}

/// Returns the rows of plan and run with their sensitivities.
std::vector<BudgetRow> rows_at(const UncertaintyPlan& plan, const TodPoint& point, const Conversion& at,
                               const std::optional<double>& deviation_k, std::span<const BudgetRow> of_run) {
  std::vector<BudgetRow> rows = plan.rows;
  rows.insert(rows.end(), of_run.begin(), of_run.end());
  if (point.delta_t_se_k > 0 && std::isfinite(point.delta_t_se_k)) {
    rows.push_back({.name = std::string(seen_contrast_row),
                    .value = point.delta_t_se_k,
                    .degrees_of_freedom = freedom_of_contrast(point),
                    .unit = "K",
                    .source = "standard error over the measurements of the contrast and their triangles",
                    .enters = BudgetInput::contrast});
  }
  if (point.fit.lag_u > 0) {
    rows.push_back({.name = std::string(contrast_lag_row),
                    .value = point.fit.lag_u * std::numbers::sqrt3,
                    .distribution = BudgetDistribution::rectangular,
                    .sensitivity = 1,
                    .unit = "1",
                    .source = "max_contrast_lag_s of the plan, times the rate of the contrast",
                    .enters = BudgetInput::acuity});
  }
  if (deviation_k) {
    rows.push_back({.name = std::string(read_back_row),
                    .value = std::abs(*deviation_k),
                    .distribution = BudgetDistribution::rectangular,
                    .unit = "K",
                    .source = "mean deviation over the presentations, not corrected",
                    .enters = BudgetInput::contrast});
  }
  for (BudgetRow& row : rows) {
    row.enters = input_of(row);
    row.sensitivity = row.name == seen_contrast_row && point.fit.contrast_u > 0 ? point.fit.contrast_u / row.value
                                                                                : sensitivity_of(row, at);
  }
  return rows;
}

std::optional<double> freedom_of(const PsychometricFit& fit) {
  return fit.clusters > 1 ? std::optional(std::max(1.0, fit.clusters - 1)) : std::nullopt;
}

/// Returns the row of the finite trials from a half-width of ln S75, without the scatter of the effective contrast,
/// which has its own row.
BudgetRow trials_row(double half, const TodPoint& point) {
  const PsychometricFit& fit = point.fit;
  const auto freedom = freedom_of(fit);
  const double contrast = fit.contrast_u * distribution::quantile_above(upper_tail, freedom_of_contrast(point));
  const double lag = fit.lag_u * distribution::quantile_above(upper_tail, std::nullopt);
  half = std::sqrt(std::max(0.0, half * half - contrast * contrast - lag * lag));
  return {.name = std::string(finite_trials_row),
          .value = half / distribution::quantile_above(upper_tail, freedom),
          .degrees_of_freedom = freedom,
          .sensitivity = 1,
          .unit = "1",
          .source = "95 % interval of the fit",
          .enters = BudgetInput::acuity};
}

/// Returns whether a row cancels. The interval of the ratio to the twin already contains the scatter of the contrast.
bool cancels_in(const BudgetRow& row, BudgetCommon common) {
  if (common == BudgetCommon::twin && row.name == seen_contrast_row) return true;
  return std::find(row.common.begin(), row.common.end(), common) != row.common.end();
}

/// Combines the stated rows except those shared with `cancelled`.
JoinedUncertainty stated_of(const std::vector<AppliedRow>& rows, const std::optional<BudgetCommon>& cancelled) {
  JoinedUncertainty sum;
  for (const AppliedRow& applied : rows) {
    if (applied.row.name == finite_trials_row || (cancelled && cancels_in(applied.row, *cancelled))) continue;
    sum.add(applied.contribution, applied.row.degrees_of_freedom);
  }
  return sum;
}

/// Combines the rows; empty (no error) if the total uncertainty is 0.
Result<std::optional<CombinedUncertainty>> combined_rows(const std::vector<BudgetRow>& rows, std::uint64_t seed,
                                                         int draws) {
  if (std::none_of(rows.begin(), rows.end(),
                   [](const BudgetRow& row) { return row.value * std::abs(row.sensitivity.value_or(1)) > 0; }))
    return std::nullopt;
  TODBENCH_TRY(auto found, combined({.quantity = "ln acuity", .unit = "1", .rows = rows}, seed, draws));
  return found;
}

/// Returns the expanded half-width of ln S75 on a side with the statistical half-width `half`: the GUM value times
/// `excess`, the ratio of Monte Carlo to GUM for the mean of both sides.
Result<double> expanded_half(double half, std::vector<BudgetRow> rows, const TodPoint& point, double excess) {
  constexpr int no_draws = 0;
  rows.insert(rows.begin(), trials_row(half, point));
  TODBENCH_TRY(const auto found, combined_rows(rows, 0, no_draws));
  return found ? std::max(half, excess * found->expanded_gum) : half;
}

/// Moves a limit without a threshold outwards by the complete stated half-width.
double moved_out(double limit_mrad, const JoinedUncertainty& stated, double direction) {
  return limit_mrad * std::exp(direction * stated.half_width(upper_tail));
}

std::vector<AppliedRow> applied(const std::vector<BudgetRow>& rows, const std::vector<BudgetShare>& shares,
                                std::size_t stated) {
  std::vector<AppliedRow> out;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    out.push_back({.row = rows[i],
                   .input = rows[i].enters,
                   .standard_uncertainty = shares[i].standard_uncertainty,
                   .contribution = shares[i].contribution,
                   .share_percent = shares[i].share_percent,
                   .from_run = rows[i].name == finite_trials_row || i >= stated});
  }
  return out;
}

/// Joins a side of the interval of a ratio with the stated half-width.
std::optional<double> joined(const std::optional<double>& ratio, const std::optional<double>& side, double stated) {
  if (!ratio || !side || !(*ratio > 0) || !(*side > 0)) return std::nullopt;
  const double half = std::log(*side / *ratio);
  return *ratio * std::exp(std::copysign(std::hypot(half, stated), half));
}

std::optional<ExpandedRatio> expanded_ratio(const Comparison& comparison, double set_delta_t_k,
                                            const JoinedUncertainty& stated) {
  for (const ComparisonPoint& point : comparison.points) {
    if (!same_contrast(point.set_delta_t_k, set_delta_t_k)) continue;
    const double of95 = stated.half_width(upper_tail), of90 = stated.half_width(0.05);
    return ExpandedRatio{
        {joined(point.ratio, point.ratio_ci95.low, of95), joined(point.ratio, point.ratio_ci95.high, of95)},
        {joined(point.ratio, point.ratio_ci90.low, of90), joined(point.ratio, point.ratio_ci90.high, of90)}};
  }
  return std::nullopt;
}

Result<void> expand(PointUncertainty& out, const TodPoint& point, const std::vector<BudgetRow>& rows,
                    std::size_t stated, std::uint64_t seed) {
  const auto& [low, high] = out.statistical_mrad;
  const auto& threshold = point.fit.threshold;
  std::vector<BudgetRow> all = rows;
  const bool both = threshold && low && high && *threshold > 0;
  if (both) all.insert(all.begin(), trials_row(0.5 * std::log(*high / *low), point));
  TODBENCH_TRY(auto found, combined_rows(all, seed, session_budget_draws));
  if (found) {
    out.rows = applied(all, found->shares, stated + (both ? 1 : 0));
  } else {
    out.rows = applied(all, std::vector<BudgetShare>(all.size()), stated + (both ? 1 : 0));
  }
  const double excess = found ? found->expanded / found->expanded_gum : 1;
  if (both) out.combined = std::move(found);
  const JoinedUncertainty all_stated = stated_of(out.rows, std::nullopt);
  out.u_stated = all_stated.u();
  out.u_not_twin = stated_of(out.rows, BudgetCommon::twin).u();
  out.u_not_series = stated_of(out.rows, BudgetCommon::series).u();
  out.u_not_contrasts = stated_of(out.rows, BudgetCommon::contrasts).u();
  for (const double direction : {-1.0, 1.0}) {
    const std::optional<double>& side = direction < 0 ? low : high;
    std::optional<double>& expanded = direction < 0 ? out.expanded_mrad.low : out.expanded_mrad.high;
    if (!side || !(*side > 0)) {
      expanded = side;
    } else if (threshold && *threshold > 0) {
      TODBENCH_TRY(const auto half, expanded_half(std::abs(std::log(*side / *threshold)), rows, point, excess));
      expanded = *threshold * std::exp(direction * half);
      // Never inside the statistical interval, because of rounding or a threshold outside it.
      expanded = direction < 0 ? std::min(*expanded, *side) : std::max(*expanded, *side);
    } else {
      expanded = moved_out(*side, all_stated, direction);
    }
  }
  return {};
}

}  // namespace

const PointUncertainty* point_at(const CurveUncertainty& uncertainty, double set_delta_t_k) {
  for (const PointUncertainty& point : uncertainty.points) {
    if (same_contrast(point.set_delta_t_k, set_delta_t_k)) return &point;
  }
  return nullptr;
}

Interval deciding_interval(const TodPoint& point) {
  const auto usable = [](const PsychometricFit& fit) {
    const bool nowhere = fit.verdict == FitVerdict::flat_or_decreasing || fit.verdict == FitVerdict::underdetermined ||
                         fit.verdict == FitVerdict::no_data;
    return nowhere ? Interval{} : fit.ci95;
  };
  const Interval interval = usable(point.fit);
  return point.lapse_warning && point.free_lapse_fit ? hull_of(interval, usable(*point.free_lapse_fit)) : interval;
}

Result<std::optional<CurveUncertainty>> curve_uncertainty(const Plan& plan, const TodCurve& curve,
                                                          std::span<const Presentation> presentations,
                                                          const std::optional<Comparison>& comparison,
                                                          const std::optional<double>& source_loss) {
  if (!plan.uncertainty.stated()) return std::nullopt;
  CurveUncertainty out;
  out.u_scale = relative_u_of_scale(plan);
  out.u_camera_scale = relative_u_of_camera_scale(plan);
  out.u_distance = relative_u_of_distance(plan);
  const auto air = row_of_air(plan, presentations);
  std::vector<BudgetRow> of_run;
  if (air) of_run.push_back(*air);
  if (source_loss) of_run.push_back(row_of_source(*source_loss));
  for (const BudgetInput input : not_stated(plan.uncertainty)) {
    if (input != BudgetInput::air_path || !air) out.not_stated.emplace_back(to_string(input));
  }
  const std::vector<double> slopes = contrast_slopes(curve);
  bool read_back = true;
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const TodPoint& point = curve.points[i];
    PointUncertainty found{.set_delta_t_k = point.set_delta_t_k, .contrast_slope = slopes[i], .rows = {}};
    const Interval interval = deciding_interval(point);
    found.statistical_mrad = interval;
    // Without a threshold, the known end of its interval is the size.
    const double size_mrad = point.fit.threshold.value_or(interval.low.value_or(interval.high.value_or(1)));
    const double distance_m = plan.target.distance_m;
    const auto deviation_k = read_back_deviation_k(presentations, point.set_delta_t_k);
    read_back = read_back && deviation_k;
    const std::vector<BudgetRow> rows = rows_at(plan.uncertainty, point,
                                                {.distance_m = distance_m,
                                                 .size_m = size_mrad * 1e-3 * distance_m,
                                                 .contrast_k = contrast_seen_k(point),
                                                 .slope = slopes[i]},
                                                deviation_k, of_run);
    if (auto expanded = expand(found, point, rows, plan.uncertainty.rows.size(), plan.seed); !expanded)
      return tl::unexpected(with_context("[uncertainty]", expanded.error()));
    if (comparison)
      found.ratio =
          expanded_ratio(as_decided(*comparison), point.set_delta_t_k, stated_of(found.rows, BudgetCommon::twin));
    out.points.push_back(std::move(found));
  }
  if (!read_back) out.not_stated.emplace_back(read_back_row);
  if (has_contrast_measured_once(curve)) out.not_stated.push_back(std::string(seen_contrast_row) + " (measured once)");
  return out;
}

}  // namespace todbench
