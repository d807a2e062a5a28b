// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/judgement/measure_demands.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "acquisition/base/normal.h"
#include "bench/judgement/limit_decision.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

/// Demand on a measure.
struct MeasureDemand {
  DemandKind kind;
  LimitedMeasure measure;
  LimitSide side;
  std::string_view name, unit, words;
};
constexpr std::array measure_demands{
    MeasureDemand{DemandKind::netd, LimitedMeasure::netd, LimitSide::at_most, "netd", "K", "NETD at most "},
    MeasureDemand{DemandKind::temporal_noise, LimitedMeasure::temporal_noise, LimitSide::at_most, "temporal_noise", "K",
                  "temporal noise of a pixel at most "},
    MeasureDemand{DemandKind::noise_t, LimitedMeasure::noise_t, LimitSide::at_most, "noise_t", "K",
                  "3-D noise t at most "},
    MeasureDemand{DemandKind::noise_v, LimitedMeasure::noise_v, LimitSide::at_most, "noise_v", "K",
                  "3-D noise v at most "},
    MeasureDemand{DemandKind::noise_h, LimitedMeasure::noise_h, LimitSide::at_most, "noise_h", "K",
                  "3-D noise h at most "},
    MeasureDemand{DemandKind::noise_tv, LimitedMeasure::noise_tv, LimitSide::at_most, "noise_tv", "K",
                  "3-D noise tv at most "},
    MeasureDemand{DemandKind::noise_th, LimitedMeasure::noise_th, LimitSide::at_most, "noise_th", "K",
                  "3-D noise th at most "},
    MeasureDemand{DemandKind::noise_vh, LimitedMeasure::noise_vh, LimitSide::at_most, "noise_vh", "K",
                  "3-D noise vh at most "},
    MeasureDemand{DemandKind::noise_tvh, LimitedMeasure::noise_tvh, LimitSide::at_most, "noise_tvh", "K",
                  "3-D noise tvh at most "},
    MeasureDemand{DemandKind::temperature_scale_at_least, LimitedMeasure::transfer_slope, LimitSide::at_least,
                  "temperature_scale_at_least", "K/K", "observed contrast over shown contrast at least "},
    MeasureDemand{DemandKind::temperature_scale_at_most, LimitedMeasure::transfer_slope, LimitSide::at_most,
                  "temperature_scale_at_most", "K/K", "observed contrast over shown contrast at most "},
    MeasureDemand{DemandKind::mtf_x, LimitedMeasure::mtf_x, LimitSide::at_least, "mtf_x", "1",
                  "MTF along x at the frequency of the plan at least "},
    MeasureDemand{DemandKind::mtf_y, LimitedMeasure::mtf_y, LimitSide::at_least, "mtf_y", "1",
                  "MTF along y at the frequency of the plan at least "},
    MeasureDemand{DemandKind::ctf_x, LimitedMeasure::ctf_x, LimitSide::at_least, "ctf_x", "1",
                  "CTF along x of the bars nearest to the frequency of the plan, best phase, at least "},
    MeasureDemand{DemandKind::ctf_y, LimitedMeasure::ctf_y, LimitSide::at_least, "ctf_y", "1",
                  "CTF along y of the bars nearest to the frequency of the plan, best phase, at least "},
    MeasureDemand{DemandKind::ifov_x_at_least, LimitedMeasure::ifov_x, LimitSide::at_least, "ifov_x_at_least", "mrad",
                  "IFOV along x at least "},
    MeasureDemand{DemandKind::ifov_x_at_most, LimitedMeasure::ifov_x, LimitSide::at_most, "ifov_x_at_most", "mrad",
                  "IFOV along x at most "},
    MeasureDemand{DemandKind::ifov_y_at_least, LimitedMeasure::ifov_y, LimitSide::at_least, "ifov_y_at_least", "mrad",
                  "IFOV along y at least "},
    MeasureDemand{DemandKind::ifov_y_at_most, LimitedMeasure::ifov_y, LimitSide::at_most, "ifov_y_at_most", "mrad",
                  "IFOV along y at most "},
    MeasureDemand{DemandKind::distortion, LimitedMeasure::distortion, LimitSide::at_most, "distortion", "%",
                  "distortion at the corner, of either sign, at most "},
    MeasureDemand{DemandKind::drift_rate, LimitedMeasure::drift_rate, LimitSide::at_most, "drift_rate", "K/min",
                  "drift of the mean after a correction, of either sign, at most "},
    MeasureDemand{DemandKind::drift_pattern_rate, LimitedMeasure::drift_pattern_rate, LimitSide::at_most,
                  "drift_pattern_rate", "K/min", "growth of the spatial noise after a correction at most "},
    MeasureDemand{DemandKind::response_time, LimitedMeasure::response_time, LimitSide::at_most, "response_time", "ms",
                  "response time at most "},
};

const MeasureDemand& demand_of(DemandKind kind) {
  const auto* const found = std::find_if(measure_demands.begin(), measure_demands.end(),
                                         [&](const MeasureDemand& demand) { return demand.kind == kind; });
  assert(found != measure_demands.end());
  return *found;
}

/// Returns the relative standard uncertainty of a measure from the budget.
double stated_u(LimitedMeasure measure, const CurveUncertainty* uncertainty) {
  if (uncertainty == nullptr) return 0;
  // A ratio of contrasts in one picture: common errors cancel.
  if (is_modulation(measure) || measure == LimitedMeasure::distortion) return 0;
  if (measure == LimitedMeasure::response_time) return 0;
  if (is_ifov(measure)) return uncertainty->u_distance;
  const bool of_scale = measure == LimitedMeasure::transfer_slope || measure == LimitedMeasure::netd;
  return of_scale ? uncertainty->u_scale : uncertainty->u_camera_scale;
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

Demand judged(const MeasureDemand& asked, double limit, const JudgementInput& evidence) {
  Demand demand{.kind = asked.kind, .limit = limit};
  demand.conformity = ConformityDecision::inconclusive;
  const MeasuredQuantity* measured = quantity_of(evidence, to_string(asked.measure));
  if (measured == nullptr || !measured->value) {
    demand.reason = "this quantity was not measured";
    return demand;
  }
  demand.result = measured->value;
  demand.interval = measured->ci95;
  if (asked.measure == LimitedMeasure::distortion || asked.measure == LimitedMeasure::drift_rate) {
    demand.result = std::abs(*measured->value);
    demand.interval = of_either_sign(measured->ci95);
  }
  if (const double u = stated_u(asked.measure, evidence.uncertainty); evidence.uncertainty != nullptr) {
    demand.statistical = demand.interval;
    demand.interval = expanded(*demand.result, *demand.statistical, u);
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

template <DemandKind kind>
std::vector<Demand> judge_measure(const JudgementInput& evidence) {
  const MeasureDemand& asked = demand_of(kind);
  std::vector<Demand> demands;
  for (const MeasureLimit& limits : evidence.limits.measures) {
    const auto& limit = asked.side == LimitSide::at_least ? limits.at_least : limits.at_most;
    if (limits.measure == asked.measure && limit) demands.push_back(judged(asked, *limit, evidence));
  }
  return demands;
}

std::string measure_in_words(const Demand& demand) {
  const MeasureDemand& asked = demand_of(demand.kind);
  return std::string(asked.words) + (demand.limit ? number_text(*demand.limit) : "(no number)") +
         unit_words(asked.unit);
}

template <DemandKind kind>
DemandKindRow row() {
  const MeasureDemand& asked = demand_of(kind);
  return {kind, asked.name, asked.unit, asked.side, judge_measure<kind>, measure_in_words};
}

}  // namespace

std::optional<LimitedMeasure> limited_measure_of(DemandKind kind) {
  for (const MeasureDemand& demand : measure_demands) {
    if (demand.kind == kind) return demand.measure;
  }
  return std::nullopt;
}

DemandKindRow measure_row(DemandKind kind) {
  switch (kind) {
    case DemandKind::netd:
      return row<DemandKind::netd>();
    case DemandKind::temporal_noise:
      return row<DemandKind::temporal_noise>();
    case DemandKind::noise_t:
      return row<DemandKind::noise_t>();
    case DemandKind::noise_v:
      return row<DemandKind::noise_v>();
    case DemandKind::noise_h:
      return row<DemandKind::noise_h>();
    case DemandKind::noise_tv:
      return row<DemandKind::noise_tv>();
    case DemandKind::noise_th:
      return row<DemandKind::noise_th>();
    case DemandKind::noise_vh:
      return row<DemandKind::noise_vh>();
    case DemandKind::noise_tvh:
      return row<DemandKind::noise_tvh>();
    case DemandKind::temperature_scale_at_least:
      return row<DemandKind::temperature_scale_at_least>();
    case DemandKind::temperature_scale_at_most:
      return row<DemandKind::temperature_scale_at_most>();
    case DemandKind::mtf_x:
      return row<DemandKind::mtf_x>();
    case DemandKind::mtf_y:
      return row<DemandKind::mtf_y>();
    case DemandKind::ctf_x:
      return row<DemandKind::ctf_x>();
    case DemandKind::ctf_y:
      return row<DemandKind::ctf_y>();
    case DemandKind::ifov_x_at_least:
      return row<DemandKind::ifov_x_at_least>();
    case DemandKind::ifov_x_at_most:
      return row<DemandKind::ifov_x_at_most>();
    case DemandKind::ifov_y_at_least:
      return row<DemandKind::ifov_y_at_least>();
    case DemandKind::ifov_y_at_most:
      return row<DemandKind::ifov_y_at_most>();
    case DemandKind::distortion:
      return row<DemandKind::distortion>();
    case DemandKind::drift_rate:
      return row<DemandKind::drift_rate>();
    case DemandKind::drift_pattern_rate:
      return row<DemandKind::drift_pattern_rate>();
    case DemandKind::response_time:
      return row<DemandKind::response_time>();
    case DemandKind::acuity:
    case DemandKind::identified:
    case DemandKind::equivalence:
    case DemandKind::scene_dependence:
    case DemandKind::zone_bad_pixels:
    case DemandKind::zone_substituted_pixels:
    case DemandKind::zone_clusters:
    case DemandKind::zone_largest_cluster:
      break;
  }
  assert(false && "no measure");
  return row<DemandKind::netd>();
}

}  // namespace todbench
