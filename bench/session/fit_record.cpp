// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/fit_record.h"

#include <array>

#include "bench/text/json_fields.h"
#include "bench/text/spread_text.h"
#include "tod/psychometric/acuity.h"
#include "tod/psychometric/contrast_slope.h"

namespace todbench {

namespace {

constexpr std::array fit_verdicts{
    FitVerdict::no_data, FitVerdict::above_range,        FitVerdict::below_range,     FitVerdict::slope_unidentifiable,
    FitVerdict::step,    FitVerdict::flat_or_decreasing, FitVerdict::underdetermined, FitVerdict::extrapolated,
    FitVerdict::ok};
constexpr std::array comparison_verdicts{ComparisonVerdict::equivalent, ComparisonVerdict::different,
                                         ComparisonVerdict::inconclusive};

void twin_shape_fields(JsonFields& json, TwinShapeUse& use) {
  json.value("size_ratio", use.size_ratio);
  json.value("slope_ratio", use.slope_ratio);
  json.value("slope_fitted", use.slope_fitted);
  json.value("departure", use.departure);
  json.value("departure_limit", use.departure_limit);
  json.value("departure_shift", use.departure_shift);
  json.value("shape_se_ln_threshold", use.shape_se_ln_threshold);
  json.later("lapse_inflation", use.lapse_inflation);
  json.value("size_mrad", use.table.size_mrad);
  json.value("proportion_correct", use.table.proportion_correct);
  json.value("standard_error", use.table.standard_error);
}

void posterior_fields(JsonFields& json, Posterior& posterior) {
  Interval ci95{posterior.low, posterior.high};
  json.value("median", posterior.median);
  json.value("ci95", ci95);
  json.value("prior_bound", posterior.prior_bound);
  posterior.low = ci95.low.value_or(0);
  posterior.high = ci95.high.value_or(0);
}

/// The keys of fit_json().
void printed_fit_fields(JsonFields& json, PsychometricFit& fit) {
  json.value("verdict", fit.verdict, fit_verdicts);
  json.value("threshold", fit.threshold);
  json.value("ci95", fit.ci95);
  json.value("slope", fit.slope);
  json.later("slope_at_cap", fit.slope_at_cap);
  json.value("lapse", fit.lapse);
  json.value("log_likelihood", fit.log_likelihood);
  json.value("deviance", fit.deviance);
  json.value("degrees_of_freedom", fit.degrees_of_freedom);
  json.value("posterior", fit.posterior, posterior_fields);
}

void fit_fields(JsonFields& json, PsychometricFit& fit) {
  printed_fit_fields(json, fit);
  json.value("ci90", fit.ci90);
  json.value("se_ln_threshold", fit.se_ln_threshold);
  json.value("trials", fit.trials);
  json.value("clusters", fit.clusters);
  json.value("variance_inflation", fit.variance_inflation);
  json.later("joined_u", fit.joined_u);
  json.later("contrast_u", fit.contrast_u);
  if (json.reading() || fit.lag_u > 0) json.later("lag_u", fit.lag_u);
  if (json.reading() && fit.clusters > 0) fit.interval = IntervalKind::clusters;  // in records without the key
  json.later("interval", fit.interval, all_interval_kinds);
  json.later("dispersion", fit.dispersion);
  json.later("twin_shape", fit.twin_shape, twin_shape_fields);
  // Earlier records hold meaningless numbers here.
  if (json.reading() && fit.verdict == FitVerdict::flat_or_decreasing) remove_threshold(fit);
}

void finding_fields(JsonFields& json, AdequacyFinding& finding) {
  json.value("kind", finding.kind, all_finding_kinds);
  json.value("value", finding.value);
  json.value("limit", finding.limit);
  json.value("sentence", finding.sentence);
  json.value("unfit", finding.unfit);
}

void adequacy_fields(JsonFields& json, Adequacy& adequacy) {
  json.derived("adequate", adequacy.adequate());
  json.value("findings", adequacy.findings, finding_fields);
}

void level_fields(JsonFields& json, Level& level) {
  json.value("size_mrad", level.size);
  json.value("correct", level.correct);
  json.value("total", level.total);
  json.value("cluster", level.cluster);
}

void direction_fields(JsonFields& json, DirectionAnswers& one) {
  json.value("trials", one.trials);
  json.value("correct", one.correct);
  json.value("percent", one.percent);
}

void orientation_fields(JsonFields& json, Orientations& found) {
  for (const Apex apex : all_apexes)
    json.value(std::string(to_string(apex)), found.directions[static_cast<std::size_t>(apex)], direction_fields);
  json.value("axes_percent", found.axes_percent);
  json.value("axes_se_percent", found.axes_se_percent);
  json.value("set_ups", found.set_ups);
  json.value("p", found.p);
}

/// The error of the contrast and its degrees of freedom, as they are used.
void contrast_fields(JsonFields& json, TodPoint& point) {
  std::optional<double> error = contrast_se_k(point), freedom = freedom_of_contrast(point);
  json.value("delta_t_se_k", error);
  json.later("delta_t_shared_se_k", point.delta_t_shared_se_k);
  json.later("delta_t_measurements", point.delta_t_measurements);
  json.later("delta_t_degrees_of_freedom", freedom);
  if (!json.reading()) return;
  point.delta_t_se_k = error.value_or(0);
  point.delta_t_freedom = freedom;
}

void curve_point_fields(JsonFields& json, TodPoint& point) {
  json.value("set_delta_t_k", point.set_delta_t_k);
  json.value("delta_t_k", point.delta_t_k);
  contrast_fields(json, point);
  json.value("fit", point.fit, fit_fields);
  json.derived("estimator", to_string(estimator_of(point.fit)));
  json.later("estimator_reason", point.estimator_reason, all_estimator_reasons);
  json.begin("answers_reason", point.answers);
  json.member("answers", point.answers, &AnswersTaken::kind, all_answer_kinds);
  json.member("frames_per_presentation", point.answers, &AnswersTaken::frames);
  json.member("answers_reason", point.answers, &AnswersTaken::reason, all_answers_reasons);
  json.value("free_lapse_fit", point.free_lapse_fit, fit_fields);
  json.value("lapse_warning", point.lapse_warning);
  json.later("adequacy", point.adequacy, adequacy_fields);
  json.value("direct_s75_mrad", point.direct_s75_mrad);
  json.value("direct_s75_se_mrad", point.direct_s75_se_mrad);
  spread_if_any(json, "s75_spread_mrad", point.s75_spread_mrad);
  json.later("saturated_share", point.saturated_share);
  json.later("noise_counts", point.noise_counts);
  json.later("lag1_correlation", point.lag1_correlation);
  json.if_any("orientations", point.orientations, orientation_fields);
  json.value("levels", point.levels, level_fields);
}

void continuous_fields(JsonFields& json, ContinuousPoint& point) {
  json.value("delta_t_k", point.delta_t_k);
  json.value("s75_mrad", point.s75_mrad);
  json.value("s75_ci95_mrad", point.ci95);
}

void curve_fields(JsonFields& json, TodCurve& curve) {
  json.value("observer", curve.observer);
  json.value("sensor", curve.sensor);
  json.value("points", curve.points, curve_point_fields);
  if (json.reading() || !curve.continuous.empty()) json.later("continuous", curve.continuous, continuous_fields);
}

void curves_fields(JsonFields& json, StoredCurves& curves) {
  json.value("main", curves.main, curve_fields);
  json.value("twin", curves.twin, curve_fields);
}

void paired_fields(JsonFields& json, RatioOfPairs& paired) {
  json.value("ratio", paired.ratio);
  json.value("ratio_ci95", paired.ci95);
  json.value("ratio_ci90", paired.ci90);
  json.value("se_ln_ratio", paired.se_ln_ratio);
  json.value("degrees_of_freedom", paired.degrees_of_freedom);
  json.value("p_difference", paired.p_difference);
  json.value("p_equivalence", paired.p_equivalence);
  json.value("verdict", paired.verdict, comparison_verdicts);
  json.value("interval", paired.interval, all_interval_kinds);
  json.value("twin_share", paired.twin_share);
  json.value("draws", paired.draws);
  json.value("pairs", paired.answers);
}

/// The keys of a point of comparison_json().
void printed_compared_fields(JsonFields& json, ComparisonPoint& point) {
  json.value("delta_t_k", point.set_delta_t_k);
  json.derived("set_delta_t_k", json_number(point.set_delta_t_k));
  json.derived("seen_delta_t_k", json_number(point.delta_t_a_k));
  json.value("ratio", point.ratio);
  json.value("ratio_ci95", point.ratio_ci95);
  json.value("p_difference", point.p_difference);
  json.value("p_equivalence", point.p_equivalence);
  json.value("margin_percent", point.margin_percent);
  json.value("verdict", point.verdict, comparison_verdicts);
  json.if_any("paired", point.paired, paired_fields);
}

void compared_fields(JsonFields& json, ComparisonPoint& point) {
  printed_compared_fields(json, point);
  json.value("delta_t_a_k", point.delta_t_a_k);
  json.value("delta_t_b_k", point.delta_t_b_k);
  json.value("ratio_ci90", point.ratio_ci90);
  json.later("withheld", point.withheld);
}

template <typename Point>
void comparison_fields(JsonFields& json, Comparison& comparison, const Point& point_of) {
  json.value("points", comparison.points, point_of);
  json.value("verdict", comparison.verdict, comparison_verdicts);
  if (decided_by_pairs(comparison)) json.derived("decided_by", "paired");
  json.if_any("adequacy", comparison.adequacy, adequacy_fields);
}

void effect_fields(JsonFields& json, EffectDecision& effect) {
  std::string decision = effect.decision == Decision::simulate ? "simulate" : "skip";
  json.value("name", effect.effect, all_effects);
  json.value("decision", decision);
  json.value("reason", effect.reason);
  json.value("predicted_change_percent", effect.predicted_change_percent);
  if (json.reading() || effect.on_request) json.later("on_request", effect.on_request);
  effect.decision = decision == "skip" ? Decision::skip : Decision::simulate;
}

}  // namespace

Json fit_json(const PsychometricFit& fit) {
  return printed_json(fit, printed_fit_fields);
}

Json adequacy_json(const std::optional<Adequacy>& adequacy) {
  return adequacy ? printed_json(*adequacy, adequacy_fields) : Json(nullptr);
}

Json comparison_json(const Comparison& comparison) {
  return printed_json(comparison, [](JsonFields& json, Comparison& described) {
    comparison_fields(json, described, printed_compared_fields);
  });
}

Json effects_json(const SensorPlan& plan) {
  Json list = Json::array();
  for (const EffectDecision& effect : plan.decisions) list.push_back(printed_json(effect, effect_fields));
  return list;
}

Result<Json> curve_record(const TodCurve& curve) {
  return json_of(curve, curve_fields);
}

Result<TodCurve> curve_from(const Json& record) {
  return from_json<TodCurve>(record, curve_fields);
}

Result<Json> curves_record(const StoredCurves& curves) {
  return json_of(curves, curves_fields);
}

Result<StoredCurves> curves_from(const Json& record) {
  return from_json<StoredCurves>(record, curves_fields);
}

Result<Json> comparison_record(const Comparison& comparison) {
  return json_of(comparison,
                 [](JsonFields& json, Comparison& described) { comparison_fields(json, described, compared_fields); });
}

Result<Comparison> comparison_from(const Json& record) {
  return from_json<Comparison>(record, [](JsonFields& json, Comparison& read) {
    json.if_any("adequacy", read.adequacy, adequacy_fields);
    // Earlier records do not state the contrast of an unfit threshold: it may be any of their points.
    const bool unfit = read.adequacy && !read.adequacy->adequate();
    comparison_fields(json, read, [unfit](JsonFields& item, ComparisonPoint& point) {
      point.withheld = unfit;
      compared_fields(item, point);
    });
  });
}

void effects_fields(JsonFields& json, SensorPlan& plan) {
  json.value("effects", plan.decisions, effect_fields);
}

}  // namespace todbench
