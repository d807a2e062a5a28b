// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/fit_record.h"

#include <array>

#include "bench/session/json_output.h"
#include "bench/text/json_reader.h"
#include "tod/psychometric/contrast_slope.h"

namespace todbench {

namespace {

constexpr std::array fit_verdicts{
    FitVerdict::no_data, FitVerdict::above_range,        FitVerdict::below_range,     FitVerdict::slope_unidentifiable,
    FitVerdict::step,    FitVerdict::flat_or_decreasing, FitVerdict::underdetermined, FitVerdict::extrapolated,
    FitVerdict::ok};
constexpr std::array comparison_verdicts{ComparisonVerdict::equivalent, ComparisonVerdict::different,
                                         ComparisonVerdict::inconclusive};

Json numbers_json(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(json_number(value));
  return list;
}

std::vector<double> numbers_from(const JsonReader& reader) {
  std::vector<double> values;
  for (const JsonReader& item : reader.elements()) values.push_back(item.number());
  return values;
}

Json twin_shape_record(const TwinShapeUse& use) {
  Json json;
  json["size_ratio"] = json_number(use.size_ratio);
  json["slope_ratio"] = json_number(use.slope_ratio);
  json["slope_fitted"] = use.slope_fitted;
  json["departure"] = json_number(use.departure);
  json["departure_limit"] = json_number(use.departure_limit);
  json["departure_shift"] = json_number(use.departure_shift);
  json["shape_se_ln_threshold"] = json_number(use.shape_se_ln_threshold);
  json["lapse_inflation"] = json_number(use.lapse_inflation);
  json["size_mrad"] = numbers_json(use.table.size_mrad);
  json["proportion_correct"] = numbers_json(use.table.proportion_correct);
  json["standard_error"] = numbers_json(use.table.standard_error);
  return json;
}

std::optional<TwinShapeUse> read_twin_shape(const JsonReader& reader) {
  if (reader.is_null()) return std::nullopt;
  TwinShapeUse use;
  use.size_ratio = reader.at("size_ratio").number();
  use.slope_ratio = reader.at("slope_ratio").number();
  use.slope_fitted = reader.at("slope_fitted").flag();
  use.departure = reader.at("departure").number();
  use.departure_limit = reader.at("departure_limit").number();
  use.departure_shift = reader.at("departure_shift").number();
  use.shape_se_ln_threshold = reader.at("shape_se_ln_threshold").number();
  use.lapse_inflation = reader.at_if_there("lapse_inflation").optional_number().value_or(1);
  use.table = {numbers_from(reader.at("size_mrad")), numbers_from(reader.at("proportion_correct")),
               numbers_from(reader.at("standard_error"))};
  return use;
}

Json fit_record(const PsychometricFit& fit) {
  Json json = fit_json(fit);
  json["ci90"] = json_interval(fit.ci90);
  json["se_ln_threshold"] = json_number(fit.se_ln_threshold);
  json["trials"] = json_number(fit.trials);
  json["clusters"] = json_number(fit.clusters);
  json["variance_inflation"] = json_number(fit.variance_inflation);
  json["joined_u"] = json_number(fit.joined_u);
  json["contrast_u"] = json_number(fit.contrast_u);
  json["interval"] = to_string(fit.interval);
  json["dispersion"] = json_number(fit.dispersion);
  json["twin_shape"] = fit.twin_shape ? twin_shape_record(*fit.twin_shape) : Json(nullptr);
  return json;
}

PsychometricFit read_fit(const JsonReader& reader) {
  PsychometricFit fit;
  fit.verdict = reader.at("verdict").named(fit_verdicts);
  fit.threshold = reader.at("threshold").optional_number();
  // Earlier records hold a meaningless number here.
  if (fit.verdict == FitVerdict::flat_or_decreasing) fit.threshold.reset();
  fit.ci95 = reader.at("ci95").interval();
  fit.ci90 = reader.at("ci90").interval();
  fit.slope = reader.at("slope").optional_number();
  if (const JsonReader at_cap = reader.at_if_there("slope_at_cap"); !at_cap.is_null()) fit.slope_at_cap = at_cap.flag();
  fit.lapse = reader.at("lapse").number();
  fit.log_likelihood = reader.at("log_likelihood").optional_number();
  fit.deviance = reader.at("deviance").optional_number();
  fit.degrees_of_freedom = static_cast<int>(reader.at("degrees_of_freedom").whole());
  fit.se_ln_threshold = reader.at("se_ln_threshold").optional_number();
  fit.trials = reader.at("trials").number();
  fit.clusters = reader.at("clusters").number();
  fit.variance_inflation = reader.at("variance_inflation").number();
  fit.joined_u = reader.at_if_there("joined_u").optional_number().value_or(0);
  fit.contrast_u = reader.at_if_there("contrast_u").optional_number().value_or(0);
  if (const JsonReader kind = reader.at_if_there("interval"); !kind.is_null()) {
    fit.interval = kind.named(all_interval_kinds);
  } else if (fit.clusters > 0) {
    fit.interval = IntervalKind::clusters;
  }
  fit.dispersion = reader.at_if_there("dispersion").optional_number();
  fit.twin_shape = read_twin_shape(reader.at_if_there("twin_shape"));
  if (const JsonReader posterior = reader.at("posterior"); !posterior.is_null()) {
    const Interval interval = posterior.at("ci95").interval();
    fit.posterior = Posterior{posterior.at("median").number(), interval.low.value_or(0), interval.high.value_or(0),
                              posterior.at("prior_bound").flag()};
  }
  return fit;
}

std::optional<Adequacy> read_adequacy(const JsonReader& reader) {
  if (reader.is_null()) return std::nullopt;
  Adequacy adequacy;
  for (const JsonReader& item : reader.at("findings").elements()) {
    adequacy.findings.push_back({item.at("kind").named(all_finding_kinds), item.at("value").optional_number(),
                                 item.at("limit").optional_number(), item.at("sentence").text(),
                                 item.at("unfit").flag()});
  }
  return adequacy;
}

Json level_record(const Level& level) {
  Json json;
  json["size_mrad"] = json_number(level.size);
  json["correct"] = json_number(level.correct);
  json["total"] = json_number(level.total);
  json["cluster"] = level.cluster;
  return json;
}

Json point_record(const TodPoint& point) {
  Json json;
  json["set_delta_t_k"] = json_number(point.set_delta_t_k);
  json["delta_t_k"] = json_number(point.delta_t_k);
  json["delta_t_se_k"] = json_number(contrast_se_k(point));
  json["delta_t_shared_se_k"] = json_number(point.delta_t_shared_se_k);
  json["delta_t_measurements"] = point.delta_t_measurements;
  json["delta_t_degrees_of_freedom"] = json_number(freedom_of_contrast(point));
  json["fit"] = fit_record(point.fit);
  json["estimator"] = to_string(estimator_of(point.fit));
  json["estimator_reason"] = point.estimator_reason ? Json(to_string(*point.estimator_reason)) : Json(nullptr);
  add_answers(json, point);
  json["free_lapse_fit"] = point.free_lapse_fit ? fit_record(*point.free_lapse_fit) : Json(nullptr);
  json["lapse_warning"] = point.lapse_warning;
  json["adequacy"] = adequacy_json(point.adequacy);
  json["direct_s75_mrad"] = json_number(point.direct_s75_mrad);
  json["direct_s75_se_mrad"] = json_number(point.direct_s75_se_mrad);
  json["saturated_share"] = json_number(point.saturated_share);
  json["noise_counts"] = json_number(point.noise_counts);
  json["lag1_correlation"] = json_number(point.lag1_correlation);
  json["levels"] = Json::array();
  for (const Level& level : point.levels) json["levels"].push_back(level_record(level));
  return json;
}

TodPoint read_point(const JsonReader& reader) {
  TodPoint point;
  point.set_delta_t_k = reader.at("set_delta_t_k").number();
  point.delta_t_k = reader.at("delta_t_k").number();
  if (const JsonReader error = reader.at("delta_t_se_k"); !error.is_null()) point.delta_t_se_k = error.number();
  if (const JsonReader count = reader.at_if_there("delta_t_measurements"); !count.is_null())
    point.delta_t_measurements = static_cast<int>(count.whole());
  if (const JsonReader shared = reader.at_if_there("delta_t_shared_se_k"); !shared.is_null())
    point.delta_t_shared_se_k = shared.number();
  if (const JsonReader freedom = reader.at_if_there("delta_t_degrees_of_freedom"); !freedom.is_null())
    point.delta_t_freedom = freedom.number();
  point.fit = read_fit(reader.at("fit"));
  if (const JsonReader reason = reader.at_if_there("estimator_reason"); !reason.is_null())
    point.estimator_reason = reason.named(all_estimator_reasons);
  if (const JsonReader reason = reader.at_if_there("answers_reason"); !reason.is_null()) {
    point.answers =
        AnswersTaken{reader.at("answers").named(all_answer_kinds),
                     static_cast<int>(reader.at("frames_per_presentation").whole()), reason.named(all_answers_reasons)};
  }
  if (const JsonReader free = reader.at("free_lapse_fit"); !free.is_null()) point.free_lapse_fit = read_fit(free);
  point.lapse_warning = reader.at("lapse_warning").flag();
  point.adequacy = read_adequacy(reader.at_if_there("adequacy"));
  point.direct_s75_mrad = reader.at("direct_s75_mrad").optional_number();
  point.direct_s75_se_mrad = reader.at("direct_s75_se_mrad").optional_number();
  point.saturated_share = reader.at_if_there("saturated_share").optional_number().value_or(0);
  point.noise_counts = reader.at_if_there("noise_counts").optional_number();
  point.lag1_correlation = reader.at_if_there("lag1_correlation").optional_number();
  for (const JsonReader& level : reader.at("levels").elements()) {
    point.levels.push_back({level.at("size_mrad").number(), level.at("correct").number(), level.at("total").number(),
                            static_cast<int>(level.at("cluster").whole())});
  }
  return point;
}

}  // namespace

Json curve_record(const TodCurve& curve) {
  Json json;
  json["observer"] = curve.observer;
  json["sensor"] = curve.sensor;
  json["points"] = Json::array();
  for (const TodPoint& point : curve.points) json["points"].push_back(point_record(point));
  return json;
}

Result<TodCurve> curve_from(const Json& record) {
  const JsonReader reader(record);
  TodCurve curve;
  curve.observer = reader.at("observer").text();
  curve.sensor = reader.at("sensor").text();
  for (const JsonReader& point : reader.at("points").elements()) curve.points.push_back(read_point(point));
  if (const Result<void> read = reader.finish(); !read) return tl::unexpected(read.error());
  return curve;
}

Json comparison_record(const Comparison& comparison) {
  Json json = comparison_json(comparison);
  for (std::size_t i = 0; i < comparison.points.size(); ++i) {
    const ComparisonPoint& point = comparison.points[i];
    json["points"][i]["delta_t_a_k"] = json_number(point.delta_t_a_k);
    json["points"][i]["delta_t_b_k"] = json_number(point.delta_t_b_k);
    json["points"][i]["ratio_ci90"] = json_interval(point.ratio_ci90);
    json["points"][i]["withheld"] = point.withheld;
  }
  return json;
}

namespace {

RatioOfPairs read_paired(const JsonReader& reader) {
  RatioOfPairs paired;
  paired.ratio = reader.at("ratio").number();
  paired.ci95 = reader.at("ratio_ci95").interval();
  paired.ci90 = reader.at("ratio_ci90").interval();
  paired.se_ln_ratio = reader.at("se_ln_ratio").number();
  paired.degrees_of_freedom = reader.at("degrees_of_freedom").number();
  paired.p_difference = reader.at("p_difference").number();
  paired.p_equivalence = reader.at("p_equivalence").number();
  paired.verdict = reader.at("verdict").named(comparison_verdicts);
  paired.interval = reader.at("interval").named(all_interval_kinds);
  paired.twin_share = reader.at("twin_share").number();
  paired.draws = static_cast<int>(reader.at("draws").whole());
  paired.answers = static_cast<int>(reader.at("pairs").whole());
  return paired;
}

}  // namespace

Result<Comparison> comparison_from(const Json& record) {
  const JsonReader reader(record);
  Comparison comparison;
  comparison.verdict = reader.at("verdict").named(comparison_verdicts);
  comparison.adequacy = read_adequacy(reader.at_if_there("adequacy"));
  for (const JsonReader& item : reader.at("points").elements()) {
    ComparisonPoint point;
    point.set_delta_t_k = item.at("delta_t_k").number();
    point.delta_t_a_k = item.at("delta_t_a_k").number();
    point.delta_t_b_k = item.at("delta_t_b_k").number();
    point.ratio = item.at("ratio").optional_number();
    point.ratio_ci95 = item.at("ratio_ci95").interval();
    point.ratio_ci90 = item.at("ratio_ci90").interval();
    point.p_difference = item.at("p_difference").optional_number();
    point.p_equivalence = item.at("p_equivalence").optional_number();
    point.margin_percent = item.at("margin_percent").number();
    point.verdict = item.at("verdict").named(comparison_verdicts);
    // Earlier records do not state the contrast of an unfit threshold: it may be any of their points.
    if (const JsonReader withheld = item.at_if_there("withheld"); !withheld.is_null())
      point.withheld = withheld.flag();
    else
      point.withheld = comparison.adequacy && !comparison.adequacy->adequate();
    if (const JsonReader paired = item.at_if_there("paired"); !paired.is_null()) point.paired = read_paired(paired);
    comparison.points.push_back(point);
  }
  if (const Result<void> read = reader.finish(); !read) return tl::unexpected(read.error());
  return comparison;
}

Result<SensorPlan> effects_from(const Json& effects) {
  const JsonReader reader(effects);
  SensorPlan plan;
  for (const JsonReader& item : reader.elements()) {
    EffectDecision decision;
    decision.effect = item.at("name").named(all_effects);
    decision.decision = item.at("decision").text() == "skip" ? Decision::skip : Decision::simulate;
    decision.reason = item.at("reason").text();
    decision.predicted_change_percent = item.at("predicted_change_percent").optional_number();
    plan.decisions.push_back(std::move(decision));
  }
  if (const Result<void> read = reader.finish(); !read) return tl::unexpected(read.error());
  return plan;
}

}  // namespace todbench
