// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/limit_forecast.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "acquisition/base/distributions.h"
#include "acquisition/base/normal.h"
#include "acquisition/base/try.h"
#include "bench/forecast/decision_forecast.h"
#include "bench/judgement/acuity_uncertainty.h"
#include "bench/plan/quantity.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

/// Guard band over standard uncertainty.
double guard_of(const LimitsPlan& limits) {
  if (limits.rule == ConformityRule::simple) return 0;
  return limits.guard_band_risk ? guard_band_for_risk(*limits.guard_band_risk, {.value = 0, .u = 1}) : normal_z95;
}

const FleetRow* row_of_acuity(const LimitsPlan& limits, double delta_t_k) {
  for (const FleetRow& row : limits.fleets)
    if (row.measure == fleet_acuity && row.delta_t_k && same_contrast(*row.delta_t_k, delta_t_k)) return &row;
  return nullptr;
}

Result<LimitOutlook> outlook(const LimitsPlan& limits, const FleetRow* row, double u, double ln_acuity,
                             double ln_limit) {
  const distribution::Normal normal;
  LimitOutlook out{.u_ln_acuity = u, .guard_band_ln = guard_of(limits) * u};
  const double accepted_from = ln_limit + out.guard_band_ln;
  out.p_rejected = cdf(normal, (accepted_from - ln_acuity) / u);
  out.passes_95_from_per_mrad = std::exp(accepted_from + quantile(normal, 0.95) * u);
  if (limits.fleet_sd_percent) {
    TODBENCH_TRY(out.fleet, global_risks({.mean = ln_acuity, .sd = std::log1p(*limits.fleet_sd_percent / 100)}, {u},
                                         {.at_least = ln_limit}, {.at_least = accepted_from}));
  }
  if (row != nullptr) {
    TODBENCH_TRY(out.earlier, fleet_forecast(prior_of(*row), u, {.at_least = ln_limit}, {.at_least = accepted_from}));
  }
  return out;
}

std::string percent(double share) {
  return fmt::format("{:.{}f} %", 100 * share, share < 0.1 ? 1 : 0);
}

std::string words_of_fleet(const FleetForecast& now, const FleetForecast& better, std::string_view with) {
  return fmt::format(
      "in the fleet of {} earlier units {} of the good units will not pass (at most {}), {} {} ({}); bad units "
      "accepted: {} ({})",
      now.units, percent(now.good_rejected), percent(now.good_rejected_most), with, percent(better.good_rejected),
      percent(better.good_rejected_most), percent(now.bad_accepted), percent(better.bad_accepted));
}

/// Replaces the chances of the normal law by those that `plan --decide` states.
void as_decided(LimitOutlook& out, const ExpectedUncertainty& expected, double ln_acuity, double ln_limit,
                const LimitsPlan& limits) {
  const auto passes = [&](double ln_over) { return decision_chances(ln_over, expected, limits).pass; };
  out.p_rejected = 1 - passes(ln_acuity - ln_limit);
  constexpr double likely = 0.95, widest = 2;
  double low = 0, high = widest;
  if (passes(high) < likely) return;
  for (int i = 0; i < 40; ++i) {
    const double middle = (low + high) / 2;
    (passes(middle) < likely ? low : high) = middle;
  }
  out.passes_95_from_per_mrad = std::exp(ln_limit + high);
}

}  // namespace

TodCurve expected_curve(const PlanPrediction& prediction) {
  TodCurve curve;
  for (const ContrastPrediction& contrast : prediction.contrasts) {
    TodPoint point;
    point.set_delta_t_k = point.delta_t_k = contrast.delta_t_k;
    point.fit.verdict = FitVerdict::ok;
    point.fit.threshold = contrast.s75_mrad;
    if (contrast.s75_mrad && contrast.uncertainty_percent) {
      const double half = std::log1p(*contrast.uncertainty_percent / 100);
      point.fit.ci95 = {*contrast.s75_mrad * std::exp(-half), *contrast.s75_mrad * std::exp(half)};
    }
    curve.points.push_back(std::move(point));
  }
  return curve;
}

Result<std::vector<LimitForecast>> limit_forecasts(const Plan& plan, const PlanPrediction& prediction) {
  std::vector<LimitForecast> forecasts;
  if (plan.limits.acuity.empty()) return forecasts;
  const TodCurve curve = expected_curve(prediction);
  TODBENCH_TRY(const auto budget, curve_uncertainty(plan, curve, {}, std::nullopt));
  for (const AcuityLimit& limit : plan.limits.acuity) {
    const TodPoint* point = point_at(curve, limit.delta_t_k);
    if (point == nullptr || !point->fit.threshold || !point->fit.ci95.high) continue;
    const ContrastPrediction* contrast = expected_at(prediction, limit.delta_t_k);
    const auto expected =
        contrast == nullptr ? std::nullopt : expected_uncertainty(*contrast, budget ? &*budget : nullptr);
    const double trials = expected ? expected->se * expected->interval_factor / normal_z95
                                   : std::log(*point->fit.ci95.high / *point->fit.threshold) / normal_z95;
    const PointUncertainty* stated = budget ? point_at(*budget, limit.delta_t_k) : nullptr;
    const double u_stated = stated != nullptr ? stated->u_stated : 0;
    const double ln_acuity = -std::log(*point->fit.threshold), ln_limit = std::log(limit.least_acuity_per_mrad);
    const FleetRow* row = row_of_acuity(plan.limits, limit.delta_t_k);
    const double share = expected && contrast->contrast_half_width > 0
                             ? contrast->contrast_half_width / (expected->se * expected->interval_factor)
                             : 0;
    const double of_four = std::hypot(std::sqrt(std::max(0.0, 1 - share * share)) / 2, share);
    auto planned = outlook(plan.limits, row, std::hypot(trials, u_stated), ln_acuity, ln_limit);
    auto fourfold = outlook(plan.limits, row, std::hypot(trials * of_four, u_stated), ln_acuity, ln_limit);
    if (!planned) return tl::unexpected(planned.error());
    if (!fourfold) return tl::unexpected(fourfold.error());
    if (expected) {
      ExpectedUncertainty with_four = *expected;
      with_four.se *= of_four;
      as_decided(*planned, *expected, ln_acuity, ln_limit, plan.limits);
      as_decided(*fourfold, with_four, ln_acuity, ln_limit, plan.limits);
    }
    forecasts.push_back({.delta_t_k = limit.delta_t_k,
                         .least_acuity_per_mrad = limit.least_acuity_per_mrad,
                         .expected_acuity_per_mrad = std::exp(ln_acuity),
                         .planned = *planned,
                         .fourfold = *fourfold});
  }
  return forecasts;
}

std::string in_words(const LimitForecast& forecast) {
  std::string text = fmt::format(
      "{} K, at least {} 1/mrad: a camera like the simulated one ({:.4g} 1/mrad) does not pass with a probability of "
      "{}, or {} with four times the presentations; a camera with at least {:.4g} 1/mrad ({:.4g}) passes with a "
      "probability of 95 %",
      number_text(forecast.delta_t_k), number_text(forecast.least_acuity_per_mrad), forecast.expected_acuity_per_mrad,
      percent(forecast.planned.p_rejected), percent(forecast.fourfold.p_rejected),
      forecast.planned.passes_95_from_per_mrad, forecast.fourfold.passes_95_from_per_mrad);
  if (forecast.planned.fleet && forecast.fourfold.fleet) {
    text +=
        fmt::format("; in the fleet, good units rejected: {} ({}), bad units accepted: {} ({})",
                    percent(forecast.planned.fleet->producer_risk), percent(forecast.fourfold.fleet->producer_risk),
                    percent(forecast.planned.fleet->consumer_risk), percent(forecast.fourfold.fleet->consumer_risk));
  }
  if (forecast.planned.earlier && forecast.fourfold.earlier)
    text += "; " +
            words_of_fleet(*forecast.planned.earlier, *forecast.fourfold.earlier, "with four times the presentations");
  return text;
}

Result<std::vector<MeasureForecast>> measure_forecasts(const LimitsPlan& limits) {
  std::vector<MeasureForecast> forecasts;
  for (const MeasureLimit& limit : limits.measures) {
    // The fleet of a quantity without sign is not normally distributed.
    const Quantity* quantity = find_limited_quantity(limit.measure);
    if (quantity == nullptr || quantity->absolute) continue;
    const auto row = std::find_if(limits.fleets.begin(), limits.fleets.end(),
                                  [&](const FleetRow& one) { return one.measure == limit.measure; });
    if (row == limits.fleets.end() || !(row->u > 0)) continue;
    MeasureForecast forecast{.measure = limit.measure,
                             .at_least = limit.at_least,
                             .at_most = limit.at_most,
                             .u = row->u,
                             .as_before = {},
                             .half_u = {}};
    for (const double part : {1.0, 0.5}) {
      const double u = part * row->u, guard_band = guard_of(limits) * u;
      ToleranceLimits acceptance;
      if (limit.at_least) acceptance.at_least = *limit.at_least + guard_band;
      if (limit.at_most) acceptance.at_most = *limit.at_most - guard_band;
      const auto found =
          fleet_forecast(prior_of(*row), u, {.at_least = limit.at_least, .at_most = limit.at_most}, acceptance);
      if (!found) return tl::unexpected(found.error());
      (part == 1 ? forecast.as_before : forecast.half_u) = *found;
    }
    forecasts.push_back(forecast);
  }
  return forecasts;
}

std::string in_words(const MeasureForecast& forecast) {
  std::string text = forecast.measure;
  if (forecast.at_least) text += ", at least " + number_text(*forecast.at_least);
  if (forecast.at_most) text += ", at most " + number_text(*forecast.at_most);
  return text + fmt::format(", measured as before (u = {:.3g}): ", forecast.u) +
         words_of_fleet(forecast.as_before, forecast.half_u, "with half of this u");
}

}  // namespace todbench
