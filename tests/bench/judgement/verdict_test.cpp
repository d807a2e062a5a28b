// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/judgement/verdict.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <set>

#include "bench/judgement/demand_kinds.h"
#include "bench/judgement/verdict_record.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;

constexpr double limit_per_mrad = 0.4;
constexpr double limit_mrad = 1 / limit_per_mrad;  // S75 that just meets the limit
const double above_mrad = std::nextafter(limit_mrad, 10.0);
const double below_mrad = std::nextafter(limit_mrad, 0.0);

LimitsPlan one_limit() {
  return {{{16.9, limit_per_mrad}}, std::nullopt};
}

Verdict judged(const LimitsPlan& limits, const TodCurve& curve, const std::optional<Comparison>& comparison) {
  return judge({.limits = limits, .curve = curve, .comparison = comparison});
}

TodPoint point_with(FitVerdict verdict, std::optional<double> low_mrad, std::optional<double> high_mrad) {
  TodPoint point;
  point.set_delta_t_k = 16.9;
  point.fit.verdict = verdict;
  point.fit.ci95 = {low_mrad, high_mrad};
  if (low_mrad && high_mrad) point.fit.threshold = (*low_mrad + *high_mrad) / 2;
  return point;
}

struct Row {
  const char* name;
  FitVerdict fit;
  std::optional<double> low_mrad, high_mrad;
  VerdictKind expected;
};

void PrintTo(const Row& row, std::ostream* out) {
  *out << row.name;
}

class TruthTable : public ::testing::TestWithParam<Row> {};

TEST_P(TruthTable, TheIntervalDecides) {
  const Row& row = GetParam();

  const Verdict verdict =
      judged(one_limit(), {"o", "s", {point_with(row.fit, row.low_mrad, row.high_mrad)}}, std::nullopt);

  ASSERT_EQ(verdict.demands.size(), 1u);
  EXPECT_EQ(verdict.demands[0].decision, row.expected) << verdict.demands[0].reason;
  EXPECT_EQ(verdict.decision, row.expected);
  EXPECT_FALSE(verdict.demands[0].reason.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Acuity, TruthTable,
    ::testing::Values(
        Row{"well_above", FitVerdict::ok, 1.5, 1.8, VerdictKind::pass},
        Row{"well_below", FitVerdict::ok, 3.0, 3.5, VerdictKind::fail},
        Row{"straddling", FitVerdict::ok, 2.0, 3.0, VerdictKind::inconclusive},
        // A limit is a least value: meeting it exactly is meeting it.
        Row{"worse_end_exactly_on_the_limit", FitVerdict::ok, 2.0, limit_mrad, VerdictKind::pass},
        Row{"worse_end_one_step_beyond", FitVerdict::ok, 2.0, above_mrad, VerdictKind::inconclusive},
        Row{"worse_end_one_step_within", FitVerdict::ok, 2.0, below_mrad, VerdictKind::pass},
        Row{"better_end_exactly_on_the_limit", FitVerdict::ok, limit_mrad, 3.0, VerdictKind::inconclusive},
        Row{"better_end_one_step_beyond", FitVerdict::ok, above_mrad, 3.0, VerdictKind::fail},
        Row{"better_end_one_step_within", FitVerdict::ok, below_mrad, 3.0, VerdictKind::inconclusive},
        Row{"extrapolated_but_clear", FitVerdict::extrapolated, 1.5, 1.8, VerdictKind::pass},
        Row{"step_with_both_sides", FitVerdict::step, 3.0, 3.5, VerdictKind::fail},
        Row{"a_ridge_that_is_clear", FitVerdict::underdetermined, 1.5, 1.8, VerdictKind::inconclusive},
        Row{"a_ridge_below", FitVerdict::underdetermined, 3.0, 3.5, VerdictKind::inconclusive},
        Row{"never_right_and_limit_below", FitVerdict::above_range, 3.0, std::nullopt, VerdictKind::fail},
        Row{"never_right_and_limit_within", FitVerdict::above_range, 2.0, std::nullopt, VerdictKind::inconclusive},
        Row{"always_right_and_limit_above", FitVerdict::below_range, std::nullopt, 2.0, VerdictKind::pass},
        Row{"always_right_and_limit_within", FitVerdict::below_range, std::nullopt, 3.0, VerdictKind::inconclusive},
        Row{"no_sides", FitVerdict::slope_unidentifiable, std::nullopt, std::nullopt, VerdictKind::inconclusive},
        Row{"no_data", FitVerdict::no_data, std::nullopt, std::nullopt, VerdictKind::inconclusive},
        // At the lower bound of the slope a threshold number means nothing, however narrow.
        Row{"flat", FitVerdict::flat_or_decreasing, 1.5, 1.8, VerdictKind::inconclusive}),
    [](const auto& row) { return std::string(row.param.name); });

TEST(Judge, AContrastThatWasNotMeasuredIsInconclusive) {
  TodPoint other = point_with(FitVerdict::ok, 1.5, 1.8);
  other.set_delta_t_k = 1.93;

  const Verdict verdict = judged(one_limit(), {"o", "s", {other}}, std::nullopt);

  EXPECT_EQ(verdict.decision, VerdictKind::inconclusive);
  EXPECT_EQ(verdict.demands.at(0).reason, "this contrast was not measured");
}

TEST(Judge, ASignificantFreeLapseMakesBothFitsCount) {
  TodPoint point = point_with(FitVerdict::ok, 1.5, 1.8);
  point.free_lapse_fit = point_with(FitVerdict::ok, 2.0, 3.0).fit;
  const TodCurve without_warning{"o", "s", {point}};
  point.lapse_warning = true;
  const TodCurve with_warning{"o", "s", {point}};

  EXPECT_EQ(judged(one_limit(), without_warning, std::nullopt).decision, VerdictKind::pass);
  EXPECT_EQ(judged(one_limit(), with_warning, std::nullopt).decision, VerdictKind::inconclusive);
}

TEST(Judge, OneFailureOutweighsEverythingAndDoubtOutweighsPasses) {
  TodPoint good = point_with(FitVerdict::ok, 1.5, 1.8), open = good, bad = good;
  open.set_delta_t_k = 1.93;
  open.fit.ci95 = {2.0, 3.0};
  bad.set_delta_t_k = 0.23;
  bad.fit.ci95 = {3.0, 3.5};
  const TodCurve curve{"o", "s", {good, open, bad}};
  LimitsPlan limits = one_limit();

  EXPECT_EQ(judged(limits, curve, std::nullopt).decision, VerdictKind::pass);
  limits.acuity.push_back({1.93, limit_per_mrad});
  EXPECT_EQ(judged(limits, curve, std::nullopt).decision, VerdictKind::inconclusive);
  limits.acuity.push_back({0.23, limit_per_mrad});
  EXPECT_EQ(judged(limits, curve, std::nullopt).decision, VerdictKind::fail);
}

TEST(Judge, WithoutLimitsEveryIdentifiedThresholdPasses) {
  const Verdict verdict = judged({}, {"o", "s", {point_with(FitVerdict::ok, 2.0, 4.0)}}, std::nullopt);

  EXPECT_EQ(verdict.decision, VerdictKind::pass);
  EXPECT_FALSE(limits_asked(verdict));
  EXPECT_EQ(verdict.reason, "the plan has no limits, and every threshold was identified");
  ASSERT_EQ(verdict.demands.size(), 1u);
  const Demand& demand = verdict.demands[0];
  EXPECT_EQ(demand.kind, DemandKind::identified);
  EXPECT_EQ(demand.decision, VerdictKind::pass);
  EXPECT_EQ(demand.delta_t_k, 16.9);
  EXPECT_EQ(demand.limit, std::nullopt);
  EXPECT_DOUBLE_EQ(demand.result.value(), 1 / 3.0);
  EXPECT_EQ(demand.interval.low, 0.25);
  EXPECT_EQ(in_words(demand), "identified threshold at 16.9 K");
}

TEST(Judge, AContrastWithALimitOnAcuityDemandsNothingElse) {
  TodPoint other = point_with(FitVerdict::ok, 2.0, 3.0);
  other.set_delta_t_k = 1.93;

  const Verdict verdict =
      judged(one_limit(), {"o", "s", {point_with(FitVerdict::above_range, 2.0, std::nullopt), other}}, std::nullopt);

  ASSERT_EQ(verdict.demands.size(), 2u);
  EXPECT_EQ(verdict.demands[0].kind, DemandKind::acuity);
  EXPECT_EQ(verdict.demands[1].kind, DemandKind::identified);
  EXPECT_EQ(verdict.demands[1].delta_t_k, 1.93);
}

TEST(Judge, ADemandAtNoContrastAtAllKeepsItsKind) {
  // A contrast of zero kelvin is a contrast, not a sign for another kind.
  TodPoint point = point_with(FitVerdict::ok, 1.5, 1.8);
  point.set_delta_t_k = 0;

  const Verdict verdict = judged({{{0, limit_per_mrad}}, std::nullopt}, {"o", "s", {point}}, std::nullopt);

  ASSERT_EQ(verdict.demands.size(), 1u);
  EXPECT_EQ(verdict.demands[0].kind, DemandKind::acuity);
  EXPECT_EQ(row_of(verdict.demands[0].kind).unit, "1/mrad");
  EXPECT_EQ(verdict.decision, VerdictKind::pass);
}

TEST(Judge, WithoutLimitsAThresholdThatCannotBeIdentifiedIsInconclusive) {
  const Verdict verdict =
      judged({}, {"o", "s", {point_with(FitVerdict::above_range, 2.0, std::nullopt)}}, std::nullopt);

  EXPECT_EQ(verdict.decision, VerdictKind::inconclusive);
  EXPECT_THAT(verdict.demands.at(0).reason, HasSubstr("above_range"));
}

TEST(Judge, ACurveWithoutPointsIsInconclusive) {
  EXPECT_EQ(judged({}, {}, std::nullopt).decision, VerdictKind::inconclusive);
}

TEST(Judge, DemandedEquivalenceIsWhatTheComparisonSays) {
  const TodCurve curve{"o", "s", {point_with(FitVerdict::ok, 1.5, 1.8)}};
  const LimitsPlan limits{{}, 10.0};
  const auto with_comparison = [&](ComparisonVerdict verdict, double margin_percent) {
    ComparisonPoint point;
    point.margin_percent = margin_percent;
    return judged(limits, curve, Comparison{{point}, verdict}).decision;
  };

  EXPECT_EQ(with_comparison(ComparisonVerdict::equivalent, 10), VerdictKind::pass);
  EXPECT_EQ(with_comparison(ComparisonVerdict::different, 10), VerdictKind::fail);
  EXPECT_EQ(with_comparison(ComparisonVerdict::inconclusive, 10), VerdictKind::inconclusive);
  EXPECT_EQ(with_comparison(ComparisonVerdict::equivalent, 20),
            VerdictKind::inconclusive);  // shown for a wider margin only
  EXPECT_EQ(judged(limits, curve, std::nullopt).decision, VerdictKind::inconclusive);
}

// A comparison of an earlier record: it does not say at which contrast a threshold is unfit, and its paired verdict
// stands as it was made.
TEST(Judge, EquivalenceOfAnUnfitThresholdIsWithheldUnderEveryRule) {
  const TodCurve curve{"o", "s", {point_with(FitVerdict::ok, 1.5, 1.8)}};
  ComparisonPoint point;
  point.margin_percent = 3;
  point.ratio = 1.01;
  point.ratio_ci90 = {1.0, 1.02};
  point.verdict = ComparisonVerdict::equivalent;
  Comparison comparison{{point}, ComparisonVerdict::equivalent};
  comparison.adequacy = Adequacy{{{FindingKind::clipping, 0.79, 0, "pixels are saturated", true}}};

  for (const ConformityRule rule : conformity_rules) {
    LimitsPlan limits{{}, 3.0};
    limits.rule = rule;
    const Verdict verdict = judged(limits, curve, comparison);
    const Demand& demand = verdict.demands.at(1);
    EXPECT_EQ(demand.decision, VerdictKind::inconclusive);
    EXPECT_FALSE(demand.p_conformity);
    EXPECT_EQ(demand.reason.find("not fit for a decision"), 0u) << demand.reason;
    EXPECT_EQ(verdict.decision, VerdictKind::inconclusive);
  }
}

TEST(Judge, EquivalenceIsThatOfThePairedRatioWhereThereIsOne) {
  const TodCurve curve{"o", "s", {point_with(FitVerdict::ok, 1.5, 1.8)}};
  ComparisonPoint point;
  point.margin_percent = 3;
  point.ratio = 1.02;
  point.ratio_ci90 = {0.98, 1.0625};
  Comparison comparison{{point}, ComparisonVerdict::inconclusive};
  const Verdict before = judged({{}, 3.0}, curve, comparison);
  add_paired(comparison, 0, {.ratio = 1.01, .ci90 = {1.0, 1.02}, .verdict = ComparisonVerdict::equivalent});

  const Verdict verdict = judged({{}, 3.0}, curve, comparison);

  EXPECT_EQ(before.demands.at(1).decision, VerdictKind::inconclusive);
  EXPECT_EQ(before.demands.at(1).ratio, RatioKind::unpaired);
  const Demand& demand = verdict.demands.at(1);
  EXPECT_EQ(demand.decision, VerdictKind::pass);
  EXPECT_EQ(demand.ratio, RatioKind::paired);
  EXPECT_NEAR(demand.result.value(), 1, 1e-9);
  EXPECT_NEAR(demand.interval.high.value(), 2, 1e-9);
}

TEST(Judge, EquivalenceIsAMarginForTheLargestDeviationAndItsNinetyPercentInterval) {
  const TodCurve curve{"o", "s", {point_with(FitVerdict::ok, 1.5, 1.8)}};
  ComparisonPoint above, below;
  above.margin_percent = below.margin_percent = 10;
  above.ratio = 1.02;
  above.ratio_ci90 = {0.98, 1.0625};
  below.ratio = 0.96;
  below.ratio_ci90 = {0.9375, 0.98};

  const Verdict verdict = judged({{}, 10.0}, curve, Comparison{{above, below}, ComparisonVerdict::equivalent});

  const Demand& demand = verdict.demands.at(1);
  EXPECT_EQ(demand.kind, DemandKind::equivalence);
  EXPECT_EQ(demand.delta_t_k, std::nullopt);
  EXPECT_EQ(demand.limit, 10);
  EXPECT_EQ(row_of(demand.kind).unit, "%");
  EXPECT_NEAR(demand.result.value(), 100 * (1 / 0.96 - 1), 1e-9);
  EXPECT_NEAR(demand.interval.low.value(), 100 * (1 / 0.98 - 1), 1e-9);  // `above` may be 1, `below` is beside it
  EXPECT_NEAR(demand.interval.high.value(), 100 * (1 / 0.9375 - 1), 1e-9);
  EXPECT_EQ(demand.interval_percent, 90);
  EXPECT_EQ(in_words(demand), "acuity equivalent to the simulated twin within 10 %");
}

TEST(Judge, EquivalenceThatWasNotDemandedDoesNotCount) {
  const Comparison different{{}, ComparisonVerdict::different};

  EXPECT_EQ(judged({}, {"o", "s", {point_with(FitVerdict::ok, 1.5, 1.8)}}, different).decision, VerdictKind::pass);
}

TEST(Judge, ARunThatEndedEarlyIsJudgedByWhatThereIsAndCannotPass) {
  const auto ended_early = [](double s75_mrad) {
    const TodCurve curve{"o", "s", {point_with(FitVerdict::ok, s75_mrad, 1.05 * s75_mrad)}};
    return judge(
        {.limits = one_limit(), .curve = curve, .comparison = std::nullopt, .ended_early = "the camera was lost"});
  };

  const Verdict good = ended_early(1.5), bad = ended_early(3.0);

  EXPECT_EQ(good.demands.at(0).decision, VerdictKind::pass);
  EXPECT_EQ(good.decision, VerdictKind::inconclusive);
  EXPECT_EQ(good.reason, "the run ended early: the camera was lost");
  EXPECT_EQ(bad.decision, VerdictKind::fail);
  EXPECT_EQ(bad.ended_early, "the camera was lost");
}

TEST(Judge, DecidesNoDemandOfARunWhoseFramesContradictThePlan) {
  for (const double s75_mrad : {1.5, 3.0}) {
    const TodCurve curve{"o", "s", {point_with(FitVerdict::ok, s75_mrad, 1.05 * s75_mrad)}};

    const Verdict verdict = judge({.limits = one_limit(),
                                   .curve = curve,
                                   .comparison = std::nullopt,
                                   .ended_early = "the plate is not at the requested place",
                                   .bench_contradicts = true});

    EXPECT_EQ(verdict.demands.at(0).decision, VerdictKind::inconclusive);
    EXPECT_FALSE(verdict.demands.at(0).p_conformity);
    EXPECT_EQ(verdict.decision, VerdictKind::inconclusive);
    EXPECT_EQ(verdict.reason, "the run ended early: the plate is not at the requested place");
  }
}

TEST(Judge, ARunThatEndedBeforeAnythingWasMeasuredLeavesEveryLimitOpen) {
  const Verdict verdict = judge({.limits = {{{16.9, limit_per_mrad}}, 10.0},
                                 .curve = {},
                                 .comparison = std::nullopt,
                                 .ended_early = "the plate was not found"});

  ASSERT_EQ(verdict.demands.size(), 2u);
  EXPECT_EQ(verdict.demands[0].reason, "this contrast was not measured");
  EXPECT_EQ(verdict.demands[1].reason, "there is no comparison with a simulated twin");
  EXPECT_EQ(verdict.decision, VerdictKind::inconclusive);
}

TEST(DemandKinds, EveryKindHasOneRowWithANameAndAUnit) {
  std::set<DemandKind> kinds;
  std::set<std::string_view> names;
  for (const DemandKindRow& row : demand_kinds()) {
    EXPECT_TRUE(kinds.insert(row.kind).second);
    EXPECT_TRUE(names.insert(to_string(row.kind)).second) << to_string(row.kind);
    EXPECT_FALSE(row.kind.name.empty() || row.unit.empty());
  }
  EXPECT_EQ(names, (std::set<std::string_view>{"acuity",
                                               "source_size_loss",
                                               "netd_extended",
                                               "temperature_scale_extended_at_least",
                                               "temperature_scale_extended_at_most",
                                               "ctf_worst_x",
                                               "ctf_worst_y",
                                               "mrtd_x",
                                               "mrtd_y",
                                               "mdtd",
                                               "mrtd_mean",
                                               "mtf50_x",
                                               "mtf50_y",
                                               "orientation",
                                               "prnu",
                                               "repeatability",
                                               "shading_range",
                                               "absolute_error",
                                               "absolute_slope_at_least",
                                               "absolute_slope_at_most",
                                               "absolute_offset",
                                               "camera_pattern",
                                               "dynamic_range",
                                               "gain_ratio",
                                               "gain_settling_time",
                                               "range_high",
                                               "range_low",
                                               "source_pattern",
                                               "frame_jitter",
                                               "frame_rate_at_least",
                                               "frame_rate_at_most",
                                               "ietd",
                                               "latency",
                                               "lost_frames",
                                               "field_of_view_x_at_least",
                                               "field_of_view_x_at_most",
                                               "field_of_view_y_at_least",
                                               "field_of_view_y_at_most",
                                               "aspect_ratio_at_least",
                                               "aspect_ratio_at_most",
                                               "identified",
                                               "equivalence",
                                               "scene_dependence",
                                               "netd",
                                               "temporal_noise",
                                               "noise_t",
                                               "noise_v",
                                               "noise_h",
                                               "noise_tv",
                                               "noise_th",
                                               "noise_vh",
                                               "noise_tvh",
                                               "temperature_scale_at_least",
                                               "temperature_scale_at_most",
                                               "mtf_x",
                                               "mtf_y",
                                               "ctf_x",
                                               "ctf_y",
                                               "ifov_x_at_least",
                                               "ifov_x_at_most",
                                               "ifov_y_at_least",
                                               "ifov_y_at_most",
                                               "distortion",
                                               "drift_rate",
                                               "drift_pattern_rate",
                                               "response_time",
                                               "zone_bad_pixels",
                                               "zone_substituted_pixels",
                                               "zone_clusters",
                                               "zone_largest_cluster"}));
}

/// A verdict with every kind of demand, sides that are open and numbers that do not exist.
Verdict full_verdict() {
  TodPoint open = point_with(FitVerdict::above_range, 2.0, std::nullopt);
  open.set_delta_t_k = 0.1;
  const TodCurve curve{"o", "s", {point_with(FitVerdict::ok, 1.5, 1.0 / 0.6), open}};
  ComparisonPoint point;
  point.margin_percent = 10;
  point.ratio = 1.01;
  point.ratio_ci90 = {0.97, 1.05};
  return judge({.limits = {{{16.9, limit_per_mrad}}, 10.0},
                .curve = curve,
                .comparison = Comparison{{point}, ComparisonVerdict::equivalent},
                .ended_early = "stopped on request",
                .judged = JudgedWhen::afterwards});
}

TEST(VerdictRecord, ComesBackWithEveryFieldOfEveryKind) {
  const Json written = verdict_json(full_verdict());

  const Result<Verdict> back = verdict_from(Json::parse(to_page(written)));

  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(to_line(verdict_json(*back)), to_line(written));
  ASSERT_EQ(back->demands.size(), 3u);
  EXPECT_EQ(back->demands[0].kind, DemandKind::acuity);
  EXPECT_EQ(back->demands[0].limit, limit_per_mrad);
  EXPECT_EQ(back->demands[1].kind, DemandKind::identified);
  EXPECT_EQ(back->demands[1].interval.low, std::nullopt);
  EXPECT_EQ(back->demands[2].kind, DemandKind::equivalence);
  EXPECT_EQ(back->demands[2].delta_t_k, std::nullopt);
  EXPECT_EQ(back->ended_early, "stopped on request");
  EXPECT_EQ(back->judged, JudgedWhen::afterwards);
  EXPECT_EQ(back->decision, VerdictKind::inconclusive);
}

TEST(VerdictRecord, HasTheKeysThatOthersRelyOn) {
  const Json json = verdict_json(full_verdict());

  for (const char* key : {"schema", "decision", "reason", "rule", "rule_in_words", "demands", "ended_early", "judged"})
    EXPECT_TRUE(json.contains(key)) << key;
  for (const Json& demand : json["demands"]) {
    for (const char* key :
         {"kind", "delta_t_k", "limit", "unit", "result", "interval", "interval_percent", "decision", "reason"})
      EXPECT_TRUE(demand.contains(key)) << key;
  }
  EXPECT_EQ(json["demands"][1]["limit"], nullptr);
}

struct Damage {
  const char* name;
  std::function<void(Json&)> make;
  const char* complaint;
};

void PrintTo(const Damage& damage, std::ostream* out) {
  *out << damage.name;
}

class DamagedVerdict : public ::testing::TestWithParam<Damage> {};

TEST_P(DamagedVerdict, IsRefusedByItsKey) {
  Json json = verdict_json(full_verdict());
  GetParam().make(json);

  const Result<Verdict> verdict = verdict_from(json);

  ASSERT_FALSE(verdict);
  EXPECT_EQ(verdict.error().code, ErrorCode::invalid_input);
  EXPECT_EQ(verdict.error().message, GetParam().complaint);
}

INSTANTIATE_TEST_SUITE_P(
    Keys, DamagedVerdict,
    ::testing::Values(
        Damage{"another_schema", [](Json& j) { j["schema"] = "todbench-verdict-0"; },
               "'schema': expected 'todbench-verdict-1'"},
        Damage{"no_decision", [](Json& j) { j.erase("decision"); }, "missing key 'decision'"},
        Damage{"an_unknown_decision", [](Json& j) { j["decision"] = "passed"; }, "'decision': expected a known word"},
        Damage{"an_unknown_rule", [](Json& j) { j["rule"] = "lenient"; }, "'rule': expected a known word"},
        Damage{"an_unknown_kind", [](Json& j) { j["demands"][1]["kind"] = "beauty"; },
               "'demands[1].kind': expected a known word"},
        Damage{"another_unit", [](Json& j) { j["demands"][2]["unit"] = "1/mrad"; }, "'demands[2].unit': expected '%'"},
        Damage{"a_limit_that_is_text", [](Json& j) { j["demands"][0]["limit"] = "0.4"; },
               "'demands[0].limit': expected a number"},
        Damage{"an_interval_of_one_side", [](Json& j) { j["demands"][0]["interval"] = Json::array({1}); },
               "'demands[0].interval': expected two ends, low and high"},
        Damage{"no_list_of_demands", [](Json& j) { j["demands"] = nullptr; }, "'demands': expected a list"},
        Damage{"no_reason", [](Json& j) { j["demands"][2].erase("reason"); }, "missing key 'demands[2].reason'"}),
    [](const auto& damage) { return std::string(damage.param.name); });

TEST(Judge, NamesItsRule) {
  const Verdict verdict = judged({}, {}, std::nullopt);

  EXPECT_EQ(to_string(verdict.rule), "guarded_acceptance_and_rejection");
  EXPECT_THAT(verdict.rule_in_words, HasSubstr("95 % confidence interval as guard band"));
  EXPECT_THAT(verdict.rule_in_words, HasSubstr("ILAC-G8"));
}

TEST(Judge, SaysDemandValueAndIntervalInAcuity) {
  const Verdict verdict = judged(one_limit(), {"o", "s", {point_with(FitVerdict::ok, 1.6, 2.0)}}, std::nullopt);

  const Demand& item = verdict.demands.at(0);
  EXPECT_EQ(in_words(item), "acuity at 16.9 K at least 0.4 1/mrad");
  EXPECT_EQ(title(item), "Acuity at 16.9 K at least 0.4 1/mrad");
  EXPECT_EQ(item.limit, 0.4);
  EXPECT_DOUBLE_EQ(item.result.value(), 1 / 1.8);
  EXPECT_EQ(item.interval.low, 0.5);
  EXPECT_EQ(item.interval.high, 0.625);
  EXPECT_EQ(item.reason, "95 % interval 0.5 to 0.625 1/mrad: at or above the limit");
}

TEST(ExitCode, FollowsTheCommandLineContract) {
  EXPECT_EQ(exit_code(VerdictKind::pass), 0);
  EXPECT_EQ(exit_code(VerdictKind::fail), 1);
  EXPECT_EQ(exit_code(VerdictKind::inconclusive), 3);
  EXPECT_EQ(exit_code(ErrorCode::invalid_input), 2);
  EXPECT_EQ(exit_code(ErrorCode::not_found), 4);
  EXPECT_EQ(exit_code(ErrorCode::disconnected), 5);
  EXPECT_EQ(exit_code(ErrorCode::integrity), 5);
  EXPECT_EQ(exit_code(ErrorCode::timeout), 5);
  EXPECT_EQ(exit_code(ErrorCode::calibration), 6);
  EXPECT_EQ(exit_code(ErrorCode::io), 7);
  EXPECT_EQ(exit_code(ErrorCode::internal), 7);
  EXPECT_EQ(exit_code(ErrorCode::interrupted), 130);
}

TEST(Judge, ANumberThatIsUnfitDecidesNothingWhateverItsInterval) {
  for (const double low_mrad : {1.5, 5.0}) {
    TodPoint point = point_with(FitVerdict::ok, low_mrad, low_mrad + 0.3);
    const VerdictKind before = judged(one_limit(), {"o", "s", {point}}, std::nullopt).decision;
    ASSERT_NE(before, VerdictKind::inconclusive);
    point.adequacy = Adequacy{{{FindingKind::rounding, 0.3, 0.5, "rounding is no white noise", false}}};
    EXPECT_EQ(judged(one_limit(), {"o", "s", {point}}, std::nullopt).decision, before);

    point.adequacy->findings.push_back({FindingKind::clipping, 0.2, 0, "pixels are saturated", true});
    const Verdict limited = judged(one_limit(), {"o", "s", {point}}, std::nullopt);
    const Verdict unlimited = judged({}, {"o", "s", {point}}, std::nullopt);

    EXPECT_EQ(limited.decision, VerdictKind::inconclusive);
    EXPECT_THAT(limited.demands.at(0).reason, HasSubstr("not fit for a decision: pixels are saturated; "));
    EXPECT_EQ(unlimited.decision, VerdictKind::inconclusive);
    EXPECT_EQ(exit_code(point.fit, *point.adequacy), 3);
  }
}

TEST(ExitCode, OfAFitIsThreeWhereTheThresholdCannotBeIdentified) {
  EXPECT_EQ(exit_code(point_with(FitVerdict::ok, 1.5, 1.8).fit), 0);
  EXPECT_EQ(exit_code(point_with(FitVerdict::extrapolated, 1.5, 1.8).fit), 0);
  EXPECT_EQ(exit_code(point_with(FitVerdict::above_range, 1.5, std::nullopt).fit), 3);
  EXPECT_EQ(exit_code(point_with(FitVerdict::flat_or_decreasing, 1.5, 1.8).fit), 3);
  EXPECT_EQ(exit_code(PsychometricFit{}), 3);
}

}  // namespace
}  // namespace todbench
