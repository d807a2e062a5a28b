// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/json_output.h"

#include <gmock/gmock.h>

#include <limits>

#include "bench/session/fit_record.h"
#include "tests/bench/session/trial_values.h"
#include "tod/psychometric/acuity.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

Comparison full_comparison() {
  ComparisonPoint point;
  point.set_delta_t_k = 16.9;
  point.delta_t_a_k = 16.8;
  point.delta_t_b_k = 16.9;
  point.ratio = 1.5;
  point.ratio_ci95 = {1.25, 1.75};
  point.ratio_ci90 = {1.3, 1.7};
  point.p_difference = 0.5;
  point.p_equivalence = 0.25;
  point.margin_percent = 10;
  point.verdict = ComparisonVerdict::different;
  return {{point}, ComparisonVerdict::different};
}

TEST(FitJson, HasExactlyThePublishedKeys) {
  PsychometricFit fit = testing::full_fit(2);
  fit.slope = 3.5;
  fit.log_likelihood = -14.25;
  fit.ci95 = {1.5, 2.5};
  fit.posterior = Posterior{2.25, 1.75, 2.75, false};

  EXPECT_EQ(
      to_line(fit_json(fit)),
      R"({"verdict":"ok","threshold":2.0,"ci95":[1.5,2.5],"slope":3.5,"slope_at_cap":false,"lapse":0.01,"log_likelihood":-14.25,"deviance":5.5,)"
      R"("degrees_of_freedom":8,"posterior":{"median":2.25,"ci95":[1.75,2.75],"prior_bound":false}})");
}

TEST(FitJson, WhatDoesNotExistIsNull) {
  PsychometricFit fit;
  fit.verdict = FitVerdict::above_range;
  fit.ci95.low = 1.5;

  EXPECT_EQ(
      to_line(fit_json(fit)),
      R"({"verdict":"above_range","threshold":null,"ci95":[1.5,null],"slope":null,"slope_at_cap":false,"lapse":0.0,"log_likelihood":null,)"
      R"("deviance":null,"degrees_of_freedom":0,"posterior":null})");
}

TEST(CurveJson, HasExactlyThePublishedKeys) {
  TodPoint point;
  point.set_delta_t_k = 16.9;
  point.delta_t_k = 16.75;
  point.fit = testing::full_fit(2);
  point.fit.ci95 = {1.5, 2.5};
  point.estimator_reason = EstimatorReason::twin;
  point.answers = AnswersTaken{AnswerKind::graded, 4, AnswersReason::twin};
  point.direct_s75_mrad = 2.125;
  point.direct_s75_se_mrad = 0.25;
  const TodCurve curve{"hvs-1", "sc2000", {point}};
  const SensorPlan plan{
      {{Effect::diffraction, Decision::skip, "said so", -1.5}, {Effect::detector, Decision::simulate, "never", {}}}};

  EXPECT_EQ(
      to_line(curve_json(curve, plan, {2.5, 100, {{"incomplete", 3}}})),
      R"({"observer":"hvs-1","sensor":"sc2000","points":[{"delta_t_k":16.9,"set_delta_t_k":16.9,"seen_delta_t_k":16.75,"s75_mrad":2.0,"s75_ci95_mrad":[1.5,2.5],)"
      R"("s75_direct_mrad":2.125,"s75_direct_se_mrad":0.25,"acuity_per_mrad":0.5,"trials":640,"verdict":"ok",)"
      R"("estimator":"twin-shape","estimator_reason":"twin","answers":"graded","frames_per_presentation":4,"answers_reason":"twin",)"
      R"("interval":"set_ups","dispersion":0.375,"clusters":32.0,)"
      R"("adequacy":null}],)"
      R"("plan":[{"name":"diffraction","decision":"skip","reason":"said so","predicted_change_percent":-1.5},)"
      R"({"name":"detector","decision":"simulate","reason":"never","predicted_change_percent":null}],)"
      R"("wall_s":2.5,"frames":{"used":100,"rejected":{"incomplete":3}}})");
}

TEST(CurveJson, AMeasuredCurveHasNoDirectEstimateAndRejectedIsAnObject) {
  TodPoint point;
  point.set_delta_t_k = 0.5;
  const Json json = curve_json({"hvs-1", "camera", {point}}, {}, {});

  EXPECT_TRUE(json["points"][0]["s75_direct_mrad"].is_null());
  EXPECT_TRUE(json["points"][0]["acuity_per_mrad"].is_null());
  EXPECT_EQ(to_line(json["frames"]), R"({"used":0,"rejected":{}})");
  EXPECT_EQ(to_line(json["plan"]), "[]");
}

TEST(ComparisonJson, HasExactlyThePublishedKeys) {
  EXPECT_EQ(to_line(comparison_json(full_comparison())),
            R"({"points":[{"delta_t_k":16.9,"set_delta_t_k":16.9,"seen_delta_t_k":)" +
                to_line(json_number(full_comparison().points[0].delta_t_a_k)) +
                R"(,"ratio":1.5,"ratio_ci95":[1.25,1.75],"p_difference":0.5,"p_equivalence":0.25,)"
                R"("margin_percent":10.0,"verdict":"different"}],"verdict":"different"})");
}

TEST(PlanJson, HasExactlyThePublishedKeys) {
  const SensorPlan plan{{{Effect::detector, Decision::simulate, "always", std::nullopt}}};

  EXPECT_EQ(
      to_line(plan_json(plan, {640, 4.5, std::nullopt})),
      R"({"effects":[{"name":"detector","decision":"simulate","reason":"always","predicted_change_percent":null}],)"
      R"("trials":640,"predicted_uncertainty_percent":4.5,"predicted_s":null})");
}

TEST(Json, NeverContainsNanOrInfinityWhateverTheValues) {
  for (const double bad : {nan, infinity, -infinity}) {
    PsychometricFit fit = testing::full_fit(bad);
    fit.slope = fit.lapse = bad;
    fit.log_likelihood = fit.deviance = fit.se_ln_threshold = bad;
    fit.variance_inflation = bad;
    TodPoint point = testing::full_point(bad, bad);
    point.fit = fit;
    point.fit.trials = 5;
    const TodCurve curve{"o", "s", {point}};
    Comparison comparison = full_comparison();
    comparison.points[0].ratio = comparison.points[0].p_difference = comparison.points[0].p_equivalence = bad;
    comparison.points[0].ratio_ci95 = {bad, bad};
    comparison.points[0].margin_percent = bad;
    const SensorPlan plan{{{Effect::detector, Decision::simulate, "", bad}}};

    for (const Json& json : {fit_json(fit), curve_json(curve, plan, {bad, 0, {}}), comparison_json(comparison),
                             plan_json(plan, {1, bad, bad})}) {
      const std::string text = to_line(json);
      EXPECT_THAT(text, Not(HasSubstr("nan")));
      EXPECT_THAT(text, Not(HasSubstr("inf\"")));
      EXPECT_THAT(text, Not(HasSubstr("Infinity")));
      EXPECT_FALSE(Json::parse(text, nullptr, false).is_discarded());
    }
  }
}

TEST(CurveRecord, RefusesANumberThatWouldNotBeReadBack) {
  for (const double bad : {nan, infinity, -infinity}) {
    TodCurve curve = testing::full_curve();
    curve.points[1].fit.variance_inflation = bad;
    Comparison comparison = full_comparison();
    comparison.points[0].margin_percent = bad;

    const Result<Json> of_curve = curve_record(curve);
    const Result<Json> of_comparison = comparison_record(comparison);

    ASSERT_FALSE(of_curve);
    EXPECT_THAT(of_curve.error().message,
                StartsWith("'points[1].fit.variance_inflation': expected a finite number, found "));
    ASSERT_FALSE(of_comparison);
    EXPECT_THAT(of_comparison.error().message, StartsWith("'points[0].margin_percent': expected a finite number"));
  }
}

TEST(CurveRecord, WritesAnUnknownNumberAsNull) {
  TodCurve curve = testing::full_curve();
  curve.points[0].fit.threshold = curve.points[0].direct_s75_mrad = nan;

  const Result<TodCurve> back = curve_from(curve_record(curve).value());

  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->points[0].fit.threshold, std::nullopt);
  EXPECT_EQ(back->points[0].direct_s75_mrad, std::nullopt);
}

TEST(Json, TextThatIsNotUtf8DoesNotThrow) {
  const TodCurve curve{"\xff\xfe", "s", {}};

  EXPECT_THAT(to_line(curve_json(curve, {}, {})), HasSubstr("\"observer\":\"\xEF\xBF\xBD\xEF\xBF\xBD\""));
}

TEST(AcuityInterval, TurnsTheSidesRound) {
  const Interval acuity = acuity_interval({2.0, 4.0});
  EXPECT_EQ(acuity.low, 0.25);
  EXPECT_EQ(acuity.high, 0.5);

  const Interval open = acuity_interval({2.0, std::nullopt});
  EXPECT_EQ(open.low, std::nullopt);
  EXPECT_EQ(open.high, 0.5);
  EXPECT_EQ(acuity_interval({0.0, 4.0}).high, std::nullopt);
}

TEST(CurveRecord, ComesBackWithEveryField) {
  const TodCurve curve = testing::full_curve();

  const Result<TodCurve> back = curve_from(Json::parse(to_page(curve_record(curve).value())));

  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(to_line(curve_record(*back).value()), to_line(curve_record(curve).value()));
  ASSERT_EQ(back->points.size(), 3u);
  const TodPoint& point = back->points[2];
  EXPECT_EQ(point.set_delta_t_k, 0.23);
  EXPECT_EQ(point.fit.threshold, 3.447);
  EXPECT_EQ(point.fit.ci90.high, 3.447 / 0.96);
  EXPECT_EQ(point.fit.posterior->median, 3.447 * 1.001);
  EXPECT_EQ(point.fit.variance_inflation, 1.25);
  EXPECT_EQ(point.free_lapse_fit->threshold, 3.447 * 1.01);
  EXPECT_TRUE(point.lapse_warning);
  EXPECT_EQ(point.direct_s75_se_mrad, 0.004);
  ASSERT_EQ(point.levels.size(), 2u);
  EXPECT_EQ(point.levels[0].cluster, 3);
  EXPECT_EQ(point.levels[0].correct, 10);
}

TEST(CurveRecord, KeepsWhatSpeaksAgainstANumberAndReadsRecordsThatKnowNothingOfIt) {
  TodCurve curve = testing::full_curve();
  TodPoint& point = curve.points[0];
  point.fit.slope_at_cap = true;
  point.adequacy = Adequacy{{{FindingKind::clipping, 0.25, 0, "saturated", true},
                             {FindingKind::identity, std::nullopt, std::nullopt, "other plates", false}}};
  point.saturated_share = 0.25;
  point.noise_counts = 0.5;
  point.lag1_correlation = -0.125;
  Json old = curve_record(curve).value();
  for (const char* key : {"adequacy", "saturated_share", "noise_counts", "lag1_correlation"})
    old["points"][0].erase(key);
  old["points"][0]["fit"].erase("slope_at_cap");

  const Result<TodCurve> back = curve_from(Json::parse(to_page(curve_record(curve).value())));
  const Result<TodCurve> from_old = curve_from(old);

  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->points[0].adequacy, point.adequacy);
  EXPECT_EQ(back->points[1].adequacy, std::nullopt);
  EXPECT_TRUE(back->points[0].fit.slope_at_cap);
  EXPECT_EQ(back->points[0].saturated_share, 0.25);
  EXPECT_EQ(back->points[0].noise_counts, 0.5);
  EXPECT_EQ(back->points[0].lag1_correlation, -0.125);
  EXPECT_EQ(adequacy_json(back->points[0].adequacy)["adequate"], false);
  ASSERT_TRUE(from_old) << from_old.error().message;
  EXPECT_EQ(from_old->points[0].adequacy, std::nullopt);
  EXPECT_EQ(from_old->points[0].saturated_share, 0);
}

TEST(CurveRecord, AMissingKeyIsNamedWithItsPlace) {
  Json json = curve_record(testing::full_curve()).value();
  json["points"][1]["fit"].erase("slope");

  const Result<TodCurve> back = curve_from(json);

  ASSERT_FALSE(back);
  EXPECT_EQ(back.error().code, ErrorCode::invalid_input);
  EXPECT_EQ(back.error().message, "missing key 'points[1].fit.slope'");
}

TEST(CurveRecord, AnotherTypeIsNamedWithItsPlace) {
  Json json = curve_record(testing::full_curve()).value();
  json["points"][0]["fit"]["verdict"] = 3;

  EXPECT_EQ(curve_from(json).error().message, "'points[0].fit.verdict': expected a text");
  EXPECT_FALSE(curve_from(Json::array()));
  EXPECT_FALSE(curve_from(Json(nullptr)));
}

RatioOfPairs full_pairs() {
  return {.ratio = 1.001,
          .ci95 = {0.996, 1.006},
          .ci90 = {0.997, 1.005},
          .se_ln_ratio = 0.002,
          .degrees_of_freedom = 6.5,
          .p_difference = 0.625,
          .p_equivalence = 0.0001,
          .verdict = ComparisonVerdict::equivalent,
          .interval = IntervalKind::set_ups,
          .twin_share = 0.125,
          .draws = 24,
          .answers = 1920};
}

TEST(ComparisonRecord, KeepsThePairedRatioBesideTheUnpairedOne) {
  Comparison comparison = full_comparison();
  EXPECT_FALSE(comparison_json(comparison).contains("decided_by"));
  add_paired(comparison, 0, full_pairs());

  const Json record = comparison_record(comparison).value();
  const Result<Comparison> back = comparison_from(record);

  ASSERT_TRUE(back) << back.error().message;
  ASSERT_TRUE(back->points[0].paired);
  EXPECT_EQ(back->points[0].paired->ci90.high, 1.005);
  EXPECT_EQ(back->points[0].ratio, 1.5);
  EXPECT_EQ(back->verdict, ComparisonVerdict::equivalent) << "the paired ratio decides";
  EXPECT_EQ(record["decided_by"], "paired");
  EXPECT_EQ(to_line(comparison_record(*back).value()), to_line(record));
}

TEST(ComparisonRecord, ComesBackWithEveryField) {
  const Comparison comparison = full_comparison();

  const Result<Comparison> back = comparison_from(comparison_record(comparison).value());

  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(to_line(comparison_record(*back).value()), to_line(comparison_record(comparison).value()));
  EXPECT_EQ(back->points.at(0).ratio_ci90.low, 1.3);
  EXPECT_EQ(back->points.at(0).delta_t_a_k, 16.8);
  EXPECT_EQ(back->verdict, ComparisonVerdict::different);
}

}  // namespace
}  // namespace todbench
