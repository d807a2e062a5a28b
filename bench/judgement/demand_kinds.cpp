// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/judgement/demand_kinds.h"

#include <algorithm>
#include <cassert>
#include <cctype>
#include <cmath>

#include "bench/judgement/limit_decision.h"
#include "bench/judgement/measure_demands.h"
#include "bench/judgement/zone_demands.h"
#include "bench/text/text.h"
#include "tod/psychometric/acuity.h"
#include "tod/psychometric/contrast_slope.h"

namespace todbench {

namespace {

/// For sentences; four significant digits are finer than any interval here.
std::string rounded(double value) {
  if (value == 0) return "0";
  if (!std::isfinite(value)) return "(no number)";
  const double scale = std::pow(10.0, 3 - std::floor(std::log10(std::abs(value))));
  return number_text(std::round(value * scale) / scale);
}

std::string rounded(const std::optional<double>& value) {
  return value ? rounded(*value) : "(no number)";
}

std::string words_of(const Interval& acuity_per_mrad) {
  const auto& [low, high] = acuity_per_mrad;
  if (low && high) return "95 % interval " + rounded(*low) + " to " + rounded(*high) + " 1/mrad";
  if (low) return "one-sided 95 % limit: above " + rounded(*low) + " 1/mrad";
  if (high) return "one-sided 95 % limit: below " + rounded(*high) + " 1/mrad";
  return "no interval";
}

/// Sets the decision of a rule; conditional ones become inconclusive.
void settle(Demand& demand, const LimitAnswer& answer) {
  demand.conformity = answer.decision;
  demand.p_conformity = answer.p_conformity;
  demand.decision = kind_of(answer.decision);
}

/// Sets a demand on a number that is unfit for a decision to inconclusive, whatever its interval.
void withhold(Demand& demand, const std::optional<Adequacy>& adequacy) {
  if (!adequacy || adequacy->adequate()) return;
  demand.decision = VerdictKind::inconclusive;
  if (demand.conformity) demand.conformity = ConformityDecision::inconclusive;
  demand.p_conformity.reset();
  demand.reason =
      "not fit for a decision: " + reasons_unfit(*adequacy) + (demand.reason.empty() ? "" : "; ") + demand.reason;
}

// acuity

/// Interval of S75 that decides: the expanded one if the plan has a budget.
struct Deciding {
  Interval s75_mrad;
  std::optional<Interval> statistical_mrad{};
};

Deciding deciding_of(const TodPoint& point, const CurveUncertainty* uncertainty) {
  const PointUncertainty* found = uncertainty == nullptr ? nullptr : point_at(*uncertainty, point.set_delta_t_k);
  if (found == nullptr) return {deciding_interval(point)};
  return {found->expanded_mrad, found->statistical_mrad};
}

/// Returns the degrees of freedom of the deciding interval; empty: infinite.
std::optional<double> freedom_of(const TodPoint& point, const CurveUncertainty* uncertainty) {
  const PointUncertainty* found = uncertainty == nullptr ? nullptr : point_at(*uncertainty, point.set_delta_t_k);
  if (found != nullptr && found->combined) return found->combined->nu_eff;
  return point.fit.clusters > 1 ? std::optional(std::max(1.0, point.fit.clusters - 1)) : std::nullopt;
}

/// Interval of S75 at the set contrast if target and camera disagree about it by more than two standard errors of the
/// contrast that the camera observed. Either can be right: the interval contains those of both cases.
std::optional<Interval> interval_at_both_contrasts(const TodPoint& point, const Interval& s75_mrad,
                                                   const JudgementInput& evidence) {
  constexpr double standard_errors = 2;
  if (evidence.uncertainty != nullptr || !evidence.air_transmittance || !(contrast_seen_k(point) > 0)) return {};
  const double set_k = *evidence.air_transmittance * std::abs(point.set_delta_t_k);
  const double ln_ratio = std::log(contrast_seen_k(point) / set_k);
  const double se = contrast_se_k(point).value_or(0) / contrast_seen_k(point);
  if (!std::isfinite(ln_ratio) || std::abs(ln_ratio) <= standard_errors * se) return {};
  const std::vector<double> slopes = contrast_slopes(evidence.curve);
  const double factor = std::exp(slopes[static_cast<std::size_t>(&point - evidence.curve.points.data())] * ln_ratio);
  Interval both = s75_mrad;
  if (both.low) *both.low *= std::min(1.0, factor);
  if (both.high) *both.high *= std::max(1.0, factor);
  return both;
}

/// Judges an acuity limit. Default rule: pass if the whole 95 % interval is at or above the limit, fail if it is below;
/// a one-sided interval decides in its direction. If a free lapse rate fits the data significantly better, the union of
/// the intervals of both fits counts.
Demand judged_acuity(const AcuityLimit& limit, const JudgementInput& evidence) {
  const TodCurve& curve = evidence.curve;
  const CurveUncertainty* const uncertainty = evidence.uncertainty;
  Demand demand{.kind = DemandKind::acuity, .delta_t_k = limit.delta_t_k, .limit = limit.least_acuity_per_mrad};
  const TodPoint* point = point_at(curve, limit.delta_t_k);
  if (point == nullptr) {
    demand.reason = "this contrast was not measured";
    return demand;
  }
  Deciding deciding = deciding_of(*point, uncertainty);
  const auto both = interval_at_both_contrasts(*point, deciding.s75_mrad, evidence);
  if (both) deciding = {*both, deciding.s75_mrad};
  const Interval& s75_mrad = deciding.s75_mrad;
  const double largest_mrad = 1 / limit.least_acuity_per_mrad;
  demand.result = stated_acuity_per_mrad(point->fit);
  demand.interval = acuity_interval(s75_mrad);
  if (deciding.statistical_mrad) demand.statistical = acuity_interval(*deciding.statistical_mrad);
  demand.degrees_of_freedom = freedom_of(*point, uncertainty);
  // Compared as sizes, the estimated quantity: one rounding instead of two, so that a value can lie exactly on the
  // limit.
  const LimitAnswer answer = decide({.value = point->fit.threshold,
                                     .interval = s75_mrad,
                                     .limit = largest_mrad,
                                     .at_least = false,
                                     .scale = LimitScale::logarithmic,
                                     .degrees_of_freedom = demand.degrees_of_freedom},
                                    evidence.limits.rule, evidence.limits.guard_band_risk);
  settle(demand, answer);
  if (s75_mrad.high && *s75_mrad.high <= largest_mrad) {
    demand.reason = words_of(demand.interval) + ": at or above the limit";
  } else if (s75_mrad.low && *s75_mrad.low > largest_mrad) {
    demand.reason = words_of(demand.interval) + ": below the limit";
  } else if (s75_mrad.low && s75_mrad.high) {
    demand.reason = words_of(demand.interval) + ": the limit lies within the interval";
  } else {
    demand.reason = "the threshold cannot be identified from the data (" + std::string(to_string(point->fit.verdict)) +
                    ", " + words_of(demand.interval) + ")";
  }
  if (both)
    demand.reason += "; the camera observed " + rounded(contrast_seen_k(*point)) + " K of " +
                     rounded(std::abs(point->set_delta_t_k)) + " K, and the interval contains both contrasts";
  if (point->lapse_warning)
    demand.reason += "; a free lapse rate fits the data better, so the intervals of both fits count";
  withhold(demand, point->adequacy);
  return demand;
}

std::vector<Demand> judge_acuity(const DemandKindRow& /*row*/, const JudgementInput& evidence) {
  std::vector<Demand> demands;
  for (const AcuityLimit& limit : evidence.limits.acuity) demands.push_back(judged_acuity(limit, evidence));
  return demands;
}

std::string acuity_in_words(const DemandKindRow& /*row*/, const Demand& demand) {
  return "acuity at " + rounded(demand.delta_t_k) + " K at least " + rounded(demand.limit) + " 1/mrad";
}

// identified

Demand judged_identified(const TodPoint& point, const CurveUncertainty* uncertainty) {
  Demand demand{.kind = DemandKind::identified, .delta_t_k = point.set_delta_t_k};
  demand.interval = acuity_interval(point.fit.ci95);
  if (const auto found = deciding_of(point, uncertainty); found.statistical_mrad && threshold_identified(point.fit)) {
    demand.statistical = demand.interval;
    demand.interval = acuity_interval(found.s75_mrad);
  }
  if (threshold_identified(point.fit)) {
    demand.result = acuity_per_mrad(point.fit);
    demand.decision = VerdictKind::pass;
    demand.reason = words_of(demand.interval);
  } else {
    demand.reason =
        "the threshold cannot be identified from the data (" + std::string(to_string(point.fit.verdict)) + ")";
  }
  withhold(demand, point.adequacy);
  return demand;
}

std::vector<Demand> judge_identified(const DemandKindRow& /*row*/, const JudgementInput& evidence) {
  std::vector<Demand> demands;
  for (const TodPoint& point : evidence.curve.points) {
    const auto& limits = evidence.limits.acuity;
    if (std::any_of(limits.begin(), limits.end(),
                    [&](const auto& limit) { return same_contrast(point.set_delta_t_k, limit.delta_t_k); }))
      continue;
    demands.push_back(judged_identified(point, evidence.uncertainty));
  }
  return demands;
}

std::string identified_in_words(const DemandKindRow& /*row*/, const Demand& demand) {
  return "identified threshold at " + rounded(demand.delta_t_k) + " K";
}

// equivalence

/// Returns the deviation of a ratio from 1 in the direction in which the margin is defined.
double deviation_percent(double ratio) {
  return 100 * (std::max(ratio, 1 / ratio) - 1);
}

/// Returns the largest deviation of a ratio from 1.
std::optional<double> largest_deviation_percent(const Comparison& comparison) {
  std::optional<double> largest;
  for (const ComparisonPoint& point : comparison.points) {
    if (!point.ratio) return {};
    largest = std::max(largest.value_or(0), deviation_percent(*point.ratio));
  }
  return largest;
}

/// Returns the interval of the largest deviation from the 90 % intervals of the ratios. Two one-sided tests at 5 %
/// prove equivalence if its upper end is within the margin. An open end of a ratio leaves that end open.
Interval deviation_interval_percent(const std::vector<Interval>& ratios_90) {
  double low = 0, high = 0;
  for (const auto& [ratio_low, ratio_high] : ratios_90) {
    if (!ratio_low || !ratio_high) return {};
    const bool holds_one = *ratio_low <= 1 && *ratio_high >= 1;
    const double a = deviation_percent(*ratio_low), b = deviation_percent(*ratio_high);
    if (!holds_one) low = std::max(low, std::min(a, b));
    high = std::max({high, a, b});
  }
  if (ratios_90.empty()) return {};
  return {low, high};
}

/// Returns "; ratios with their 90 % intervals between 0.951 and 1.063"; empty if an end is open.
std::string span_of_ratios(const std::vector<Interval>& ratios_90) {
  std::optional<double> low, high;
  for (const Interval& ratio : ratios_90) {
    if (!ratio.low || !ratio.high) return {};
    low = std::min(low.value_or(*ratio.low), *ratio.low);
    high = std::max(high.value_or(*ratio.high), *ratio.high);
  }
  if (!low) return {};
  return "; 90 % intervals of the ratios between " + rounded(*low) + " and " + rounded(*high);
}

std::string reason_of(ComparisonVerdict verdict, const std::vector<Interval>& ratios_90) {
  const std::string span = span_of_ratios(ratios_90);
  switch (verdict) {
    case ComparisonVerdict::equivalent:
      return "equivalent at every contrast (two one-sided tests at 5 %)" + span;
    case ComparisonVerdict::different:
      return "different at one or more contrasts" + span;
    case ComparisonVerdict::inconclusive:
      return "these data show neither equivalence nor a difference (two one-sided tests at 5 %)" + span;
  }
  return "";
}

/// Returns the deciding 90 % interval of each contrast.
std::vector<Interval> ratios_90(const Comparison& comparison, const CurveUncertainty* uncertainty) {
  std::vector<Interval> ratios;
  for (const ComparisonPoint& point : comparison.points) {
    const PointUncertainty* found = uncertainty == nullptr ? nullptr : point_at(*uncertainty, point.set_delta_t_k);
    ratios.push_back(found != nullptr && found->ratio ? found->ratio->ci90 : point.ratio_ci90);
  }
  return ratios;
}

/// Returns the verdict of a contrast with the expanded intervals.
ComparisonVerdict expanded_verdict(const ComparisonPoint& point, const ExpandedRatio& ratio) {
  const double margin = 1 + 0.01 * point.margin_percent;
  const auto& [low, high] = ratio.ci90;
  if (point.verdict == ComparisonVerdict::equivalent && low && high && *low >= 1 / margin && *high <= margin)
    return ComparisonVerdict::equivalent;
  const bool apart = (ratio.ci95.low && *ratio.ci95.low > 1) || (ratio.ci95.high && *ratio.ci95.high < 1);
  return point.verdict == ComparisonVerdict::different && apart ? ComparisonVerdict::different
                                                                : ComparisonVerdict::inconclusive;
}

/// Returns the verdict of the comparison with the uncertainty that does not cancel between camera and twin.
ComparisonVerdict comparison_verdict(const Comparison& comparison, const CurveUncertainty* uncertainty) {
  if (uncertainty == nullptr) return comparison.verdict;
  ComparisonVerdict all = ComparisonVerdict::equivalent;
  for (const ComparisonPoint& point : comparison.points) {
    const PointUncertainty* found = point_at(*uncertainty, point.set_delta_t_k);
    const ComparisonVerdict one =
        found != nullptr && found->ratio ? expanded_verdict(point, *found->ratio) : point.verdict;
    if (one == ComparisonVerdict::different) return one;
    if (one == ComparisonVerdict::inconclusive) all = one;
  }
  // A comparison that is inconclusive as a whole remains so.
  return comparison.verdict == ComparisonVerdict::inconclusive ? comparison.verdict : all;
}

/// Decides by the rule of the plan; the two one-sided tests at 5 % are the guard band.
ConformityDecision equivalence_decision(ComparisonVerdict verdict, const Comparison& comparison,
                                        const std::vector<Interval>& ratios, ConformityRule rule) {
  if (rule == ConformityRule::guarded_acceptance_and_rejection || comparison.points.empty() ||
      (comparison.adequacy && !comparison.adequacy->adequate()))
    return conformity_of(decision_of(verdict));
  bool meets = true;
  for (std::size_t i = 0; i < ratios.size(); ++i) {
    const ComparisonPoint& point = comparison.points[i];
    if (!point.ratio || !ratios[i].low || !ratios[i].high) return ConformityDecision::inconclusive;
    meets = meets && deviation_percent(*point.ratio) <= point.margin_percent;
  }
  if (rule == ConformityRule::simple) return meets ? ConformityDecision::pass : ConformityDecision::fail;
  const ConformityDecision decision = conformity_of(decision_of(verdict));
  if (rule == ConformityRule::guarded)
    return decision == ConformityDecision::pass ? decision : ConformityDecision::fail;
  if (decision != ConformityDecision::inconclusive) return decision;
  return meets ? ConformityDecision::conditional_pass : ConformityDecision::conditional_fail;
}

/// Returns the probability that a ratio lies within the margin, from its 90 % interval; the smallest over the
/// contrasts, an upper bound for all of them together.
std::optional<double> p_equivalence(const Comparison& comparison, const std::vector<Interval>& ratios) {
  std::optional<double> least;
  for (std::size_t i = 0; i < ratios.size(); ++i) {
    const ComparisonPoint& point = comparison.points[i];
    const auto& [low, high] = ratios[i];
    if (!point.ratio || !low || !high || !(*low > 0) || !(*high > *low)) return std::nullopt;
    constexpr double z90 = 1.6448536269514722;
    const double margin = std::log1p(point.margin_percent / 100);
    const auto found = conformity({.value = std::log(*point.ratio), .u = std::log(*high / *low) / (2 * z90)},
                                  {.at_least = -margin, .at_most = margin}, ConformityRule::simple, 0);
    if (!found) return std::nullopt;
    least = std::min(least.value_or(1), found->p_conformity);
  }
  return least;
}

bool proven_different(const ComparisonPoint& point) {
  return !point.withheld && point.verdict == ComparisonVerdict::different;
}

/// Decides as the comparison does, if it used the demanded margin.
std::vector<Demand> judge_equivalence(const DemandKindRow& /*row*/, const JudgementInput& evidence) {
  if (!evidence.limits.equivalence_margin_percent) return {};
  const double margin_percent = *evidence.limits.equivalence_margin_percent;
  Demand demand{.kind = DemandKind::equivalence, .limit = margin_percent, .interval_percent = 90};
  if (!evidence.comparison) {
    demand.reason = "there is no comparison with a simulated twin";
    return {demand};
  }
  for (const ComparisonPoint& point : evidence.comparison->points) {
    if (point.margin_percent == margin_percent) continue;
    demand.reason = "the comparison used another margin, " + rounded(point.margin_percent) + " %";
    return {demand};
  }
  const Comparison decided = as_decided(*evidence.comparison);
  demand.ratio = decided_by_pairs(decided) ? RatioKind::paired : RatioKind::unpaired;
  demand.result = largest_deviation_percent(decided);
  const std::vector<Interval> ratios = ratios_90(decided, evidence.uncertainty);
  const ComparisonVerdict verdict = comparison_verdict(decided, evidence.uncertainty);
  demand.interval = deviation_interval_percent(ratios);
  if (evidence.uncertainty != nullptr) demand.statistical = deviation_interval_percent(ratios_90(decided, nullptr));
  settle(demand, {.decision = equivalence_decision(verdict, decided, ratios, evidence.limits.rule),
                  .p_conformity = p_equivalence(decided, ratios)});
  demand.reason = reason_of(verdict, ratios);
  if (demand.ratio == RatioKind::paired) demand.reason += "; ratios paired by presentation";
  // A proven difference at another contrast with fit thresholds still fails the demand.
  if (std::ranges::any_of(decided.points, proven_different)) {
    if (decided.adequacy && !decided.adequacy->adequate())
      demand.reason += "; other contrasts are not fit for a decision: " + reasons_unfit(*decided.adequacy);
  } else {
    withhold(demand, decided.adequacy);
  }
  return {demand};
}

std::string equivalence_in_words(const DemandKindRow& /*row*/, const Demand& demand) {
  return "acuity equivalent to the simulated twin within " + rounded(demand.limit) + " %";
}

std::string scene_dependence_in_words(const DemandKindRow& /*row*/, const Demand& demand) {
  return "change of the response at " + rounded(demand.delta_t_k) + " K by a hot bar in the field at most " +
         rounded(demand.limit) + " %";
}

std::vector<DemandKindRow> all_rows() {
  std::vector<DemandKindRow> rows{
      {DemandKind::acuity, "1/mrad", LimitSide::at_least, judge_acuity, acuity_in_words},
      {DemandKind::identified, "1/mrad", LimitSide::none, judge_identified, identified_in_words},
      {DemandKind::equivalence, "%", LimitSide::at_most, judge_equivalence, equivalence_in_words}};
  for (const DemandKindRow& row : measure_rows()) rows.push_back(row);
  // Made by its own session (bench/scene_dependence/scene_dependence_session.h), not from the limits of a plan.
  rows.push_back({DemandKind::scene_dependence, "%", LimitSide::at_most,
                  [](const DemandKindRow&, const JudgementInput&) { return std::vector<Demand>(); },
                  scene_dependence_in_words});
  for (const DemandKindRow& row : zone_rows()) rows.push_back(row);
  return rows;
}

const std::vector<DemandKindRow>& table() {
  static const std::vector<DemandKindRow> rows = all_rows();
  return rows;
}

}  // namespace

std::span<const DemandKindRow> demand_kinds() {
  return table();
}

const DemandKindRow& row_of(DemandKind kind) {
  const auto& rows = table();
  const auto row = std::find_if(rows.begin(), rows.end(), [&](const DemandKindRow& r) { return r.kind == kind; });
  assert(row != rows.end());
  return *row;
}

const MeasuredQuantity* quantity_of(const JudgementInput& evidence, std::string_view measure) {
  if (!evidence.measures) return nullptr;
  const auto found = std::find_if(evidence.measures->begin(), evidence.measures->end(),
                                  [&](const MeasuredQuantity& one) { return one.measure == measure; });
  return found == evidence.measures->end() ? nullptr : &*found;
}

std::string in_words(const Demand& demand) {
  const DemandKindRow& row = row_of(demand.kind);
  return row.in_words(row, demand);
}

std::string title(const Demand& demand) {
  std::string words = in_words(demand);
  if (!words.empty()) words.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(words.front())));
  return words;
}

}  // namespace todbench
