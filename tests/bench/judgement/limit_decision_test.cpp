// SPDX-License-Identifier: GPL-3.0-or-later
// One limit by every rule, limits on physical measures, and what a plan refuses because nothing could pass.
#include "bench/judgement/limit_decision.h"

#include <gmock/gmock.h>

#include <cmath>

#include "bench/judgement/demand_kinds.h"
#include "bench/judgement/verdict_record.h"
#include "bench/plan/plan.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;

constexpr double two_sided_95 = 1.959963984540054;

LimitQuestion at_least(double value, double u, double limit) {
  return {.value = value, .interval = {value - two_sided_95 * u, value + two_sided_95 * u}, .limit = limit};
}

TEST(LimitDecision, IsThatOfConformityByEveryRule) {
  // The same question as a value with its u and a guard band of 1.96 u.
  for (const double value : {0.30, 0.35, 0.395, 0.405, 0.45, 0.50}) {
    for (const ConformityRule rule : conformity_rules) {
      const double u = 0.02, limit = 0.4;
      const auto reference = conformity({.value = value, .u = u}, {.at_least = limit}, rule, two_sided_95 * u).value();
      const LimitAnswer answer = decide(at_least(value, u, limit), rule, std::nullopt);
      EXPECT_EQ(answer.decision, reference.decision) << value << " " << to_string(rule);
      EXPECT_NEAR(answer.p_conformity.value(), reference.p_conformity, 1e-12) << value;
      // The other way round.
      LimitQuestion mirrored = at_least(-value, u, -limit);
      mirrored.at_least = false;
      const LimitAnswer same = decide(mirrored, rule, std::nullopt);
      EXPECT_EQ(same.decision, answer.decision);
      EXPECT_NEAR(same.p_conformity.value(), answer.p_conformity.value(), 1e-12);
    }
  }
}

TEST(LimitDecision, HasTheGuardBandOfARisk) {
  const double u = 0.02, limit = 0.4;
  for (const double risk : {0.001, 0.05, 0.2, 0.5}) {
    const double band = guard_band_for_risk(risk, {.value = 0, .u = u});
    const auto decision = [&](double value) {
      return decide(at_least(value, u, limit), ConformityRule::guarded, risk).decision;
    };
    EXPECT_EQ(decision(limit + band + 1e-9), ConformityDecision::pass) << risk;
    EXPECT_EQ(decision(limit + band - 1e-9), ConformityDecision::fail) << risk;
    const auto answer = decide(at_least(limit + band + 1e-9, u, limit), ConformityRule::guarded, risk);
    EXPECT_NEAR(1 - answer.p_conformity.value(), risk, 1e-6);
  }
}

TEST(LimitDecision, UsesTheSideOfTheIntervalThatLooksAtTheLimitOnItsScale) {
  const LimitQuestion asked{.value = 2,
                            .interval = {1.9, 2.5},
                            .limit = 2.25,
                            .at_least = false,
                            .scale = LimitScale::logarithmic,
                            .degrees_of_freedom = 5.0};
  // u is the upper half of ln over t(0.975, 5) = 2.5706; t = ln(2.25 / 2) / u = 1.3568: below it are 0.8836 of t(5).
  EXPECT_NEAR(decide(asked, ConformityRule::simple, std::nullopt).p_conformity.value(), 0.8836, 2e-4);
}

TEST(LimitDecision, IsOpenWhereTheIntervalIs) {
  const LimitQuestion open{.value = 0.5, .interval = {0.38, std::nullopt}, .limit = 0.4};
  for (const ConformityRule rule : conformity_rules)
    EXPECT_EQ(decide(open, rule, std::nullopt).decision, ConformityDecision::inconclusive) << to_string(rule);
  EXPECT_EQ(decide({.interval = {std::nullopt, 0.3}, .limit = 0.4}, ConformityRule::simple, std::nullopt).decision,
            ConformityDecision::fail);
}

Verdict judged(const LimitsPlan& limits, std::vector<MeasuredQuantity> measures,
               const CurveUncertainty* uncertainty = nullptr) {
  TodPoint point;
  point.set_delta_t_k = 2;
  point.fit.verdict = FitVerdict::ok;
  point.fit.threshold = 2.5;
  point.fit.ci95 = {2.4, 2.6};
  const TodCurve curve{"o", "s", {point}};
  return judge({.limits = limits,
                .curve = curve,
                .comparison = std::nullopt,
                .uncertainty = uncertainty,
                .measures = std::move(measures)});
}

const Demand& demand_of(const Verdict& verdict, DemandKind kind) {
  for (const Demand& demand : verdict.demands) {
    if (demand.kind == kind) return demand;
  }
  ADD_FAILURE() << "no demand " << to_string(kind);
  return verdict.demands.front();
}

TEST(MeasureLimits, AreDemandsOfTheVerdict) {
  LimitsPlan limits;
  limits.measures = {{"netd", std::nullopt, 0.060}, {"transfer_slope", 0.95, 1.02}};

  const Verdict verdict = judged(limits, {{"netd", 0.050, {0.048, 0.052}}, {"transfer_slope", 1.03, {1.025, 1.035}}});

  EXPECT_EQ(demand_of(verdict, DemandKind{"netd"}).decision, VerdictKind::pass);
  EXPECT_EQ(demand_of(verdict, DemandKind{"temperature_scale_at_least"}).decision, VerdictKind::pass);
  EXPECT_EQ(demand_of(verdict, DemandKind{"temperature_scale_at_most"}).decision, VerdictKind::fail);
  EXPECT_LT(demand_of(verdict, DemandKind{"temperature_scale_at_most"}).producer_risk().value(), 0.025);
  EXPECT_EQ(verdict.decision, VerdictKind::fail);
  const auto back = verdict_from(verdict_json(verdict));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(verdict_json(*back).dump(), verdict_json(verdict).dump());
}

TEST(MeasureLimits, OnAnMtfAreLowerOnes) {
  LimitsPlan limits;
  limits.measures = {{"mtf_x", 0.7, std::nullopt}, {"mtf_y", 0.8, std::nullopt}};

  const Verdict verdict = judged(limits, {{"mtf_x", 0.75, {0.74, 0.76}}, {"mtf_y", 0.75, {0.74, 0.76}}});

  EXPECT_EQ(demand_of(verdict, DemandKind{"mtf_x"}).decision, VerdictKind::pass);
  EXPECT_EQ(demand_of(verdict, DemandKind{"mtf_y"}).decision, VerdictKind::fail);
  EXPECT_EQ(verdict.decision, VerdictKind::fail);
}

TEST(MeasureLimits, OnTheAxesDecideByTheContrastWithTheLargestDifference) {
  LimitsPlan limits;
  limits.measures = {{"orientation", std::nullopt, 4}};
  const auto decided = [&](std::vector<std::optional<double>> axes_percent) {
    TodCurve curve;
    for (const auto& axes : axes_percent) {
      TodPoint point;
      point.set_delta_t_k = 1.0 + static_cast<double>(curve.points.size());
      if (axes) point.orientations = Orientations{.axes_percent = *axes, .axes_se_percent = 0.5, .set_ups = 8};
      curve.points.push_back(point);
    }
    return demand_of(judge({.limits = limits, .curve = curve, .comparison = std::nullopt}), DemandKind{"orientation"});
  };

  // t(7 degrees of freedom, 97.5 %) = 2.365: half-widths of 1.18 %.
  EXPECT_EQ(decided({1, -2.5}).decision, VerdictKind::pass);
  EXPECT_EQ(decided({1, -3.5}).decision, VerdictKind::inconclusive);
  EXPECT_EQ(decided({6, -2.5}).decision, VerdictKind::fail);
  EXPECT_NEAR(decided({1, -2.5}).interval.high.value(), 2.5 + 0.5 * 2.365, 1e-3);
  EXPECT_NEAR(decided({6, -2.5}).interval.low.value(), 6 - 0.5 * 2.365, 1e-3);
  const Demand open = decided({1, std::nullopt});
  EXPECT_EQ(open.decision, VerdictKind::inconclusive);
  EXPECT_THAT(open.reason, ::testing::HasSubstr("graded answers"));
}

TEST(ZoneLimits, AreDemandsOnWhatWasSeenOfTheZone) {
  LimitsPlan limits;
  limits.zones = {{.name = "centre", .bad_pixels = 0, .clusters = 0},
                  {.name = "whole", .bad_pixels = 10, .substituted_pixels = 3}};

  const Verdict verdict = judged(limits, {{"bad_pixels (centre)", 0, {0, 0}},
                                          {"defect_clusters (centre)", 1, {1, 1}},
                                          {"bad_pixels", 8, {8, std::nullopt}},
                                          {"substituted_pixels", 4, {4, std::nullopt}}});

  const auto decision_in = [&](DemandKind kind, const std::string& zone) {
    for (const Demand& demand : verdict.demands)
      if (demand.kind == kind && demand.zone == zone) return demand.decision;
    ADD_FAILURE() << to_string(kind) << " of " << zone;
    return VerdictKind::inconclusive;
  };
  EXPECT_EQ(decision_in(DemandKind{"zone_bad_pixels"}, "centre"), VerdictKind::pass);
  EXPECT_EQ(decision_in(DemandKind{"zone_clusters"}, "centre"), VerdictKind::fail);
  // There may be more where nobody looked; too many are too many.
  EXPECT_EQ(decision_in(DemandKind{"zone_bad_pixels"}, "whole"), VerdictKind::inconclusive);
  EXPECT_EQ(decision_in(DemandKind{"zone_substituted_pixels"}, "whole"), VerdictKind::fail);
  const auto back = verdict_from(verdict_json(verdict));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(verdict_json(*back).dump(), verdict_json(verdict).dump());
}

TEST(MeasureLimits, CountTheScaleOfTheBudget) {
  LimitsPlan limits;
  limits.measures = {{"netd", std::nullopt, 0.060}, {"noise_vh", std::nullopt, 0.060}};
  CurveUncertainty uncertainty;
  uncertainty.u_scale = 0.15;

  const Verdict verdict =
      judged(limits, {{"netd", 0.050, {0.048, 0.052}}, {"noise_vh", 0.050, {0.048, 0.052}}}, &uncertainty);

  const Demand& netd = demand_of(verdict, DemandKind{"netd"});
  EXPECT_EQ(netd.decision, VerdictKind::inconclusive);
  EXPECT_NEAR(netd.interval.high.value(), 0.050 + std::hypot(0.002, two_sided_95 * 0.15 * 0.050), 1e-12);
  EXPECT_EQ(netd.statistical.value().high, 0.052);
  EXPECT_EQ(demand_of(verdict, DemandKind{"noise_vh"}).decision, VerdictKind::pass);
  // A noise that is none is not negative by its scale.
  uncertainty.u_camera_scale = 0.01;
  const Verdict none = judged(limits, {{"noise_vh", 0.001, {0.0, 0.002}}}, &uncertainty);
  EXPECT_EQ(demand_of(none, DemandKind{"noise_vh"}).interval.low.value(), 0);
}

TEST(MeasureLimits, StayOpenWhereNothingWasMeasured) {
  LimitsPlan limits;
  limits.measures = {{"netd", std::nullopt, 0.060}};

  EXPECT_EQ(judged(limits, {}).decision, VerdictKind::inconclusive);
}

TEST(FleetRisks, OfAnAcuityUseTheDegreesOfFreedomOfItsInterval) {
  LimitsPlan limits;
  limits.acuity = {{2, 0.39}};
  limits.fleets = {{.delta_t_k = 2, .mean = 0.40, .sd = 0.02, .u = 0.01, .units = 20}};
  CurveUncertainty uncertainty;
  PointUncertainty point;
  point.set_delta_t_k = 2;
  point.expanded_mrad = {2.4, 2.6};
  const auto demand_at = [&](std::optional<double> freedom) {
    point.combined.emplace().nu_eff = freedom;
    uncertainty.points = {point};
    return judged(limits, {}, &uncertainty).demands.at(0);
  };

  const Demand few = demand_at(4.0), many = demand_at(std::nullopt);

  ASSERT_TRUE(few.fleet && many.fleet);
  EXPECT_EQ(few.degrees_of_freedom, 4.0);
  EXPECT_FALSE(many.degrees_of_freedom);
  EXPECT_NE(few.fleet->producer_risk, many.fleet->producer_risk);
}

TEST(Rules, OfThePlanJudgeTheAcuityToo) {
  LimitsPlan limits;
  limits.acuity = {{2, 0.39}};  // S75 of 2.564: the limit lies within 2.4 to 2.6
  const auto by = [&](ConformityRule rule) {
    limits.rule = rule;
    return judged(limits, {}).demands.at(0);
  };

  EXPECT_EQ(by(ConformityRule::guarded_acceptance_and_rejection).decision, VerdictKind::inconclusive);
  EXPECT_EQ(by(ConformityRule::simple).decision, VerdictKind::pass);
  EXPECT_EQ(by(ConformityRule::guarded).decision, VerdictKind::fail);
  const Demand conditional = by(ConformityRule::non_binary);
  EXPECT_EQ(conditional.decision, VerdictKind::inconclusive);
  EXPECT_EQ(conditional.conformity, ConformityDecision::conditional_pass);
  EXPECT_GT(conditional.p_conformity.value(), 0.5);
  EXPECT_FALSE(conditional.consumer_risk());
}

std::string refusal(const Plan& plan) {
  const auto valid = validate(plan);
  return valid ? "accepted" : valid.error().message;
}

TEST(PlanThatNothingCanPass, IsRefused) {
  Plan plan;
  plan.measures.noise = plan.measures.transfer = true;
  plan.limits.measures = {{"transfer_slope", 0.97, 1.03}};
  EXPECT_EQ(refusal(plan), "accepted");

  plan.uncertainty.rows = {{.name = "emissivity", .value = 2, .unit = "%"}};
  EXPECT_THAT(refusal(plan), HasSubstr("no unit can pass"));
  plan.limits.rule = ConformityRule::simple;
  EXPECT_EQ(refusal(plan), "accepted");

  plan.limits = {};
  plan.limits.equivalence_margin_percent = 5;
  plan.uncertainty.rows = {{.name = "entrance pupil", .value = 100, .unit = "mm"}};
  EXPECT_THAT(refusal(plan), HasSubstr("no unit can pass"));
  plan.uncertainty.rows[0].common = {BudgetCommon::twin};
  EXPECT_EQ(refusal(plan), "accepted");
}

TEST(MeasureLimits, AreOfMeasuresThatThePlanAsksFor) {
  Plan plan;
  plan.limits.measures = {{"netd", std::nullopt, 0.060}};
  EXPECT_THAT(refusal(plan), HasSubstr("needs noise = true"));
  plan.measures.noise = true;
  EXPECT_THAT(refusal(plan), HasSubstr("needs transfer = true"));
  plan.measures.transfer = true;
  EXPECT_EQ(refusal(plan), "accepted");
  plan.limits.measures[0].at_least = 0.01;
  EXPECT_THAT(refusal(plan), HasSubstr("no lower limit"));
}

}  // namespace
}  // namespace todbench
