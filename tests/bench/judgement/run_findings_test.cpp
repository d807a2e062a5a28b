// SPDX-License-Identifier: GPL-3.0-or-later
// Findings about a whole run, and what the verdict makes of them.
#include "bench/judgement/run_findings.h"

#include <gmock/gmock.h>

#include <vector>

#include "bench/judgement/verdict.h"

namespace todbench {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TodCurve curve_at(double set_k, double seen_k) {
  TodPoint point;
  point.set_delta_t_k = set_k;
  point.delta_t_k = seen_k;
  point.delta_t_se_k = 0.01;
  point.delta_t_freedom = 7;
  point.fit.threshold = 2;
  point.fit.ci95 = {1.95, 2.05};
  point.fit.verdict = FitVerdict::ok;
  TodCurve curve;
  curve.points.push_back(point);
  return curve;
}

auto of_kind(FindingKind kind) {
  return Contains(Field(&AdequacyFinding::kind, kind));
}

/// Findings that leave no verdict.
std::vector<AdequacyFinding> found(const Plan& plan, double seen_k, double set_k = 16.9) {
  TodCurve curve = curve_at(set_k, seen_k);
  (void)add_run_findings(curve, plan, {});
  std::vector<AdequacyFinding> findings = curve.points.front().adequacy.value_or(Adequacy{}).findings;
  std::erase_if(findings, [](const AdequacyFinding& one) { return !one.unfit; });
  return findings;
}

BudgetRow relative_row(BudgetInput input, double u) {
  return {.name = std::string(to_string(input)), .value = u, .unit = "1", .enters = input};
}

TEST(ContrastDeviation, BeyondWhatIsAssumedIsAFinding) {
  // Without a budget: 2.81 standard uncertainties of 3 % and 1.5 % are 9.4 %.
  EXPECT_NEAR(allowed_contrast_deviation({}, curve_at(16.9, 16.9).points.front(), 1), 0.094, 0.001);
  EXPECT_THAT(found({}, 16.9 * 1.05), IsEmpty());
  EXPECT_THAT(found({}, 16.9 * 0.95), IsEmpty());
  for (const double factor : {1.15, 1.4, 0.8, 10.0}) {
    EXPECT_THAT(found({}, 16.9 * factor), of_kind(FindingKind::contrast_deviation)) << factor;
    EXPECT_THAT(found({}, -1.93 * factor, -1.93), of_kind(FindingKind::contrast_deviation)) << factor;
  }
}

TEST(ContrastDeviation, IsAllowedAsFarAsTheBudgetSays) {
  Plan plan;
  plan.uncertainty.rows = {relative_row(BudgetInput::black_body_calibration, 0.002),
                           relative_row(BudgetInput::camera_scale, 0.01)};
  EXPECT_THAT(found(plan, 16.9 * 1.06), of_kind(FindingKind::contrast_deviation));
  plan.uncertainty.rows.back().value = 0.05;
  EXPECT_THAT(found(plan, 16.9 * 1.06), IsEmpty());
}

TEST(ContrastDeviation, IsAllowedAsFarAsThePlanSays) {
  Plan plan;
  plan.target.max_contrast_deviation_percent = 20;
  EXPECT_THAT(found(plan, 16.9 * 1.15), IsEmpty());
  plan.target.max_contrast_deviation_percent = 2;
  EXPECT_THAT(found(plan, 16.9 * 1.03), of_kind(FindingKind::contrast_deviation));
}

TEST(ContrastDeviation, IsGrossBeyondAThirdUnlessThePlanAllowsMore) {
  Plan plan;
  plan.target.delta_t_k = {16.9, 1.93};
  EXPECT_EQ(gross_contrast_deviations(plan), (std::map<double, double>{{16.9, 1.0 / 3}, {1.93, 1.0 / 3}}));
  plan.target.max_contrast_deviation_percent = 60;
  EXPECT_DOUBLE_EQ(gross_contrast_deviations(plan).at(1.93), 0.6);
  plan.camera.contrast = ContrastUnit::grey_levels;
  EXPECT_THAT(gross_contrast_deviations(plan), IsEmpty());
}

TEST(ContrastDeviation, CannotBeSeenInGreyLevels) {
  Plan plan;
  plan.camera.contrast = ContrastUnit::grey_levels;
  EXPECT_THAT(found(plan, 16.9 * 1.4), IsEmpty());
}

TEST(ContrastDeviation, IsSeenBehindTheAir) {
  std::vector<Presentation> shown(1);
  shown.front().air_transmittance = 0.8;
  TodCurve curve = curve_at(16.9, 0.8 * 16.9);
  EXPECT_THAT(add_run_findings(curve, {}, {.presentations = shown}), IsEmpty());
}

TEST(RunFindings, LeaveNoVerdictOfTheNumber) {
  const std::optional<Comparison> no_comparison;
  for (const double limit_per_mrad : {0.4, 0.6}) {
    const LimitsPlan limits{{{16.9, limit_per_mrad}}, std::nullopt};
    TodCurve curve = curve_at(16.9, 16.9);
    const VerdictKind honest = judge({.limits = limits, .curve = curve, .comparison = no_comparison}).decision;
    EXPECT_EQ(honest, limit_per_mrad < 0.5 ? VerdictKind::pass : VerdictKind::fail);
    curve.points.front().delta_t_k *= 1.4;
    EXPECT_EQ(add_run_findings(curve, {}, {}).size(), 1U);
    EXPECT_EQ(judge({.limits = limits, .curve = curve, .comparison = no_comparison}).decision,
              VerdictKind::inconclusive);
  }
}

/// A camera that observes `seen` times the set contrast, with 1 % standard error: acuity 0.5 at 16.9 K.
Verdict judged_with(double seen, double limit_per_mrad) {
  const std::optional<Comparison> no_comparison;
  const LimitsPlan limits{{{16.9, limit_per_mrad}}, std::nullopt};
  TodCurve curve = curve_at(16.9, 16.9 * seen);
  curve.points.front().delta_t_se_k = 0.169;
  EXPECT_THAT(add_run_findings(curve, {}, {}), ::testing::SizeIs(std::abs(seen - 1) > 0.04 ? 1 : 0))
      << "noticed, and still allowed";
  EXPECT_TRUE(!curve.points.front().adequacy || curve.points.front().adequacy->adequate());
  return judge({.limits = limits, .curve = curve, .comparison = no_comparison, .air_transmittance = 1});
}

TEST(ContrastDeviation, WithinTheAllowedOneIsInTheIntervalThatDecides) {
  const double acuity = *judged_with(1, 0.1).demands.front().result;

  // The limit is 4 % below the acuity that was found. At the set contrast it is 8 % lower if the camera is right: with
  // one contrast the acuity is taken to be in proportion to it.
  const Verdict honest = judged_with(1.001, acuity / 1.04), raised = judged_with(1.08, acuity / 1.04);
  EXPECT_EQ(honest.decision, VerdictKind::pass);
  EXPECT_EQ(raised.decision, VerdictKind::inconclusive);
  const Demand& demand = raised.demands.front();
  EXPECT_NEAR(*demand.interval.low * 1.08, *demand.statistical->low, 1e-9);
  EXPECT_EQ(*demand.interval.high, *demand.statistical->high);
  EXPECT_THAT(demand.reason, ::testing::HasSubstr("the camera observed 18.25 K of 16.9 K"));
  // A lower contrast makes no unit fail that would pass at the set one.
  EXPECT_EQ(judged_with(1, acuity * 1.04).decision, VerdictKind::fail);
  EXPECT_EQ(judged_with(0.92, acuity * 1.04).decision, VerdictKind::inconclusive);
}

TEST(RunFindings, OfTheCameraConcernEveryPoint) {
  TodCurve curve = curve_at(16.9, 16.9);
  curve.points.push_back(curve_at(1.93, 1.93).points.front());
  const RunConstancy changed{.noise = {{16.9, 0.071, 0.0}, {16.9, 0.8, 0.5}}, .residue = PictureResidue{0.3, 0.02}};
  EXPECT_EQ(add_run_findings(curve, {}, {.constancy = changed}).size(), 3U);
  for (const TodPoint& point : curve.points) {
    EXPECT_THAT(point.adequacy->findings, of_kind(FindingKind::noise_change));
    EXPECT_THAT(point.adequacy->findings, of_kind(FindingKind::correlation_change));
    EXPECT_THAT(point.adequacy->findings, of_kind(FindingKind::picture_residue));
    EXPECT_FALSE(point.adequacy->adequate());
  }
}

TEST(RunFindings, NameTheChangesThatOneSetUpCannotShow) {
  const auto seen = [](double y_px) {
    ContrastMeasurement one{.set_delta_t_k = 16.9, .delta_t_k = 16.9, .references = {}};
    for (const double x_px : {100.0, 120.0, 140.0})
      one.references.push_back({.value = 16.9, .place_px = {x_px, y_px}, .size_px = 5});
    return one;
  };
  const std::vector<ContrastMeasurement> one{seen(120)}, two{seen(120), seen(205)};

  EXPECT_THAT(unchecked_changes(one, {.noise = {{16.9, 0.07, 0.0}}}),
              AllOf(HasSubstr("not checked"), HasSubstr("signal transfer, of the noise, of its correlation")));
  EXPECT_EQ(unchecked_changes(two, {.noise = {{16.9, 0.07, 0.0}, {16.9, 0.07, 0.0}}}), "");
  EXPECT_EQ(unchecked_changes({}, {}), "") << "grey levels";
}

}  // namespace
}  // namespace todbench
