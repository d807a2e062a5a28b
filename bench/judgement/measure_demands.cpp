// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/judgement/measure_demands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "acquisition/base/distributions.h"
#include "acquisition/base/normal.h"
#include "bench/judgement/limit_decision.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

/// Returns the relative standard uncertainty of a quantity from the budget.
double stated_u(StatedUncertainty stated, const CurveUncertainty& uncertainty) {
  switch (stated) {
    case StatedUncertainty::none:
      return 0;
    case StatedUncertainty::camera_scale:
      return uncertainty.u_camera_scale;
    case StatedUncertainty::scale:
      return uncertainty.u_scale;
    case StatedUncertainty::distance:
      return uncertainty.u_distance;
  }
  return 0;
}

/// Joins each side with the stated uncertainty (root sum of squares).
Interval expanded(double value, const Interval& statistical, double relative_u) {
  const double stated = normal_z95 * relative_u * std::abs(value);
  Interval out;
  if (statistical.low) out.low = value - std::hypot(value - *statistical.low, stated);
  // A quantity that cannot be negative, for example a noise, keeps its lower end at 0 or above.
  if (out.low && *statistical.low >= 0) out.low = std::max(0.0, *out.low);
  if (statistical.high) out.high = value + std::hypot(*statistical.high - value, stated);
  return out;
}

/// Returns the interval of an absolute value: from 0 if both signs are possible.
Interval of_either_sign(const Interval& interval) {
  if (!interval.low || !interval.high) return {.low = 0, .high = {}};
  const double low = std::abs(*interval.low), high = std::abs(*interval.high);
  return {.low = *interval.low * *interval.high <= 0 ? 0 : std::min(low, high), .high = std::max(low, high)};
}

/// Returns the unit to follow a number; empty for a ratio.
std::string unit_words(std::string_view unit) {
  return unit == "1" ? std::string() : " " + std::string(unit);
}

std::string words_of(const Interval& interval, std::string_view unit) {
  const auto& [low, high] = interval;
  if (low && high) return fmt::format("95 % interval {:.4g} to {:.4g}{}", *low, *high, unit_words(unit));
  if (low) return fmt::format("one-sided 95 % limit: above {:.4g}{}", *low, unit_words(unit));
  if (high) return fmt::format("one-sided 95 % limit: below {:.4g}{}", *high, unit_words(unit));
  return "no interval";
}

/// Largest difference of the axes over the contrasts, of either sign; the ends are the largest of all contrasts. Empty
/// if a contrast has no thresholds by direction.
std::optional<MeasuredQuantity> largest_orientation(const TodCurve& curve) {
  MeasuredQuantity largest{.measure = "orientation", .value = 0, .ci95 = {0, 0}};
  for (const TodPoint& point : curve.points) {
    if (!point.orientations || point.orientations->set_ups < 2) return std::nullopt;
    const double value = point.orientations->axes_percent, freedom = point.orientations->set_ups - 1;
    const double half = quantile(distribution::StudentsT(freedom), 0.975) * point.orientations->axes_se_percent;
    const Interval ends = of_either_sign({value - half, value + half});
    largest.value = std::max(*largest.value, std::abs(value));
    largest.ci95 = {std::max(*largest.ci95.low, *ends.low), std::max(*largest.ci95.high, *ends.high)};
  }
  return curve.points.empty() ? std::nullopt : std::optional(largest);
}

/// Quantities of the curve are not among those of measures.json.
std::optional<MeasuredQuantity> measured_quantity(const Quantity& quantity, const JudgementInput& evidence) {
  if (quantity.name == "orientation") return largest_orientation(evidence.curve);
  const MeasuredQuantity* found = quantity_of(evidence, quantity.name);
  return found == nullptr ? std::nullopt : std::optional(*found);
}

Demand judged(const DemandKindRow& asked, double limit, const JudgementInput& evidence) {
  const Quantity& quantity = *asked.quantity;
  Demand demand{.kind = asked.kind, .limit = limit};
  demand.conformity = ConformityDecision::inconclusive;
  const std::optional<MeasuredQuantity> measured = measured_quantity(quantity, evidence);
  if (!measured || !measured->value) {
    demand.reason = quantity.name == "orientation"
                        ? "the thresholds by direction are not known at every contrast: they need graded answers of "
                          "at least three plates and mountings"
                        : "this quantity was not measured";
    return demand;
  }
  demand.result = measured->value;
  demand.interval = measured->ci95;
  if (quantity.absolute) {
    demand.result = std::abs(*measured->value);
    demand.interval = of_either_sign(measured->ci95);
  }
  if (evidence.uncertainty != nullptr) {
    demand.statistical = demand.interval;
    demand.interval = expanded(*demand.result, *demand.statistical, stated_u(quantity.stated, *evidence.uncertainty));
  }
  const LimitAnswer answer = decide({.value = demand.result,
                                     .interval = demand.interval,
                                     .limit = limit,
                                     .at_least = asked.side == LimitSide::at_least},
                                    evidence.limits.rule, evidence.limits.guard_band_risk);
  demand.conformity = answer.decision;
  demand.p_conformity = answer.p_conformity;
  demand.decision = kind_of(answer.decision);
  demand.reason = words_of(demand.interval, asked.unit);
  return demand;
}

std::vector<Demand> judge_measure(const DemandKindRow& row, const JudgementInput& evidence) {
  std::vector<Demand> demands;
  for (const MeasureLimit& limits : evidence.limits.measures) {
    const auto& limit = row.side == LimitSide::at_least ? limits.at_least : limits.at_most;
    if (limits.measure == row.quantity->name && limit) demands.push_back(judged(row, *limit, evidence));
  }
  return demands;
}

std::string measure_in_words(const DemandKindRow& row, const Demand& demand) {
  const QuantityLimit& limit = row.side == LimitSide::at_least ? row.quantity->at_least : row.quantity->at_most;
  return std::string(limit.words) + (demand.limit ? number_text(*demand.limit) : "(no number)") + unit_words(row.unit);
}

}  // namespace

std::vector<DemandKindRow> measure_rows() {
  std::vector<DemandKindRow> rows;
  for (const Quantity& quantity : quantities()) {
    for (const LimitSide side : {LimitSide::at_least, LimitSide::at_most}) {
      const QuantityLimit& limit = side == LimitSide::at_least ? quantity.at_least : quantity.at_most;
      if (limit.possible())
        rows.push_back({DemandKind{limit.demand}, quantity.unit, side, judge_measure, measure_in_words, &quantity});
    }
  }
  return rows;
}

}  // namespace todbench
