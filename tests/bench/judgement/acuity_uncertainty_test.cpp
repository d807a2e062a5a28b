// SPDX-License-Identifier: GPL-3.0-or-later
// The budget of a plan in the intervals of a curve and in the verdict.
#include "bench/judgement/acuity_uncertainty.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "acquisition/base/rng.h"
#include "bench/judgement/verdict.h"
#include "bench/judgement/verdict_record.h"

namespace todbench {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

constexpr double z95 = 1.959963984540054;

/// A threshold with a symmetric interval of ln S75: half-width 1.96 u of very many degrees of freedom.
TodPoint point_of(double delta_t_k, double s75_mrad, double u) {
  TodPoint point;
  point.set_delta_t_k = point.delta_t_k = delta_t_k;
  point.fit.verdict = FitVerdict::ok;
  point.fit.threshold = s75_mrad;
  point.fit.ci95 = {s75_mrad * std::exp(-z95 * u), s75_mrad * std::exp(z95 * u)};
  return point;
}

Plan plan_of(std::vector<BudgetRow> rows) {
  Plan plan;
  plan.target.distance_m = 2;
  plan.uncertainty.rows = std::move(rows);
  return plan;
}

CurveUncertainty applied(const Plan& plan, const TodCurve& curve, const std::vector<Presentation>& presentations = {},
                         const std::optional<Comparison>& comparison = {}) {
  auto found = curve_uncertainty(plan, curve, presentations, comparison);
  EXPECT_TRUE(found) << found.error().message;
  return found->value();
}

const AppliedRow& row_of(const PointUncertainty& point, std::string_view name) {
  for (const AppliedRow& row : point.rows) {
    if (row.row.name == name) return row;
  }
  ADD_FAILURE() << "no row " << name;
  static const AppliedRow none;
  return none;
}

double half_of(const Interval& interval) {
  return 0.5 * std::log(*interval.high / *interval.low);
}

TEST(CurveUncertainty, AddsGeometryInSquares) {
  const Plan plan = plan_of({{.name = "distance", .value = 20, .unit = "mm"}});

  const auto found = applied(plan, {"o", "s", {point_of(2, 2.5, 0.01)}});

  const PointUncertainty& point = found.points.at(0);
  ASSERT_TRUE(point.combined);
  EXPECT_NEAR(point.combined->u, std::hypot(0.01, 0.01), 1e-12);
  EXPECT_NEAR(half_of(point.statistical_mrad), z95 * 0.01, 1e-12);
  // The draws are known to 0.35 % (one standard error); only what they exceed the GUM by counts.
  EXPECT_GE(half_of(point.expanded_mrad), z95 * 0.01 * std::sqrt(2.0) - 1e-12);
  EXPECT_LE(half_of(point.expanded_mrad), z95 * 0.01 * std::sqrt(2.0) * (1 + 4 * 0.0035));
  EXPECT_THAT(found.not_stated, Contains("cut-outs"));
  EXPECT_THAT(found.not_stated, Contains(std::string(read_back_row)));
  EXPECT_THAT(found.not_stated, ::testing::Not(Contains("distance")));
}

TEST(CurveUncertainty, CountsContrastByTheSlopeOfTheCurve) {
  TodCurve curve;
  for (const double contrast_k : {16.0, 2.0, 0.25})
    curve.points.push_back(point_of(contrast_k, 2 * std::pow(contrast_k, -0.5), 0.01));
  const Plan plan = plan_of({{.name = "black body calibration", .value = 10, .unit = "mK"},
                             {.name = "camera_scale", .value = 1, .unit = "%"},
                             {.name = "cut-outs", .value = 0.02, .unit = "mm"}});

  const auto found = applied(plan, curve);

  for (const PointUncertainty& point : found.points) {
    EXPECT_NEAR(row_of(point, "black body calibration").contribution, 0.5 * 0.010 / point.set_delta_t_k, 1e-12);
    EXPECT_NEAR(row_of(point, "camera_scale").contribution, 0.5 * 0.01, 1e-12);
    const double side_mm = 2 * std::pow(point.set_delta_t_k, -0.5) * 2;
    EXPECT_NEAR(row_of(point, "cut-outs").contribution, 0.02 / side_mm, 1e-12);
  }
}

TEST(CurveUncertainty, CountsTheScatterOfASeenContrastOnce) {
  TodPoint point = point_of(2, 2.5, 0.01);
  point.delta_t_se_k = 0.02;
  const TodPoint without = point;
  point.fit.contrast_u = point.fit.joined_u = 0.0114;
  const double half = z95 * std::hypot(0.01, 0.0114);
  point.fit.ci95 = {2.5 * std::exp(-half), 2.5 * std::exp(half)};
  const Plan plan = plan_of({{.name = "distance", .value = 20, .unit = "mm"}});

  const auto joined = applied(plan, {"o", "s", {point}}), plain = applied(plan, {"o", "s", {without}});

  const PointUncertainty& found = joined.points.at(0);
  ASSERT_TRUE(found.combined && plain.points.at(0).combined);
  EXPECT_NEAR(row_of(found, seen_contrast_row).contribution, 0.0114, 1e-12);
  EXPECT_NEAR(row_of(found, finite_trials_row).contribution, 0.01, 1e-12);
  EXPECT_NEAR(found.combined->u, std::hypot(0.01, 0.0114, 0.01), 1e-12);
  // An interval of an earlier version does not hold the contrast: the row has the slope of the curve, 1.
  EXPECT_NEAR(plain.points.at(0).combined->u, std::hypot(0.01, 0.01, 0.01), 1e-12);
}

TEST(CurveUncertainty, HoldsWhatTargetAndCameraDisagreeBy) {
  std::vector<Presentation> presentations(4);
  for (std::size_t i = 0; i < presentations.size(); ++i) {
    presentations[i].set.delta_t_k = 2;
    presentations[i].said.state.delta_t_k = 1.99;
    presentations[i].delta_t_k = i % 2 == 0 ? 2.02 : 2.04;
  }

  const auto found = applied(plan_of({{.name = "form", .value = 1, .unit = "%"}}), {"o", "s", {point_of(2, 2.5, 0.01)}},
                             presentations);

  const AppliedRow& row = row_of(found.points.at(0), read_back_row);
  EXPECT_NEAR(row.row.value, 0.04, 1e-12);
  EXPECT_NEAR(row.contribution, 0.04 / std::sqrt(3.0) / 2, 1e-12);  // the slope of a single contrast is 1
  EXPECT_TRUE(row.from_run);
  EXPECT_THAT(found.not_stated, ::testing::Not(Contains(std::string(read_back_row))));
}

TEST(CurveUncertainty, CorrectsTheReadBackForTheAirAndStatesWhatIsUncertainOfIt) {
  std::vector<Presentation> presentations(2);
  for (Presentation& shown : presentations) {
    shown.set.delta_t_k = shown.said.state.delta_t_k = 10;
    shown.delta_t_k = 9.95;
    shown.air_transmittance = 0.994;
  }
  const TodCurve curve{"o", "s", {point_of(10, 2.5, 0.01)}};
  const Plan plan = plan_of({{.name = "form", .value = 1, .unit = "%"}});
  const Plan own = plan_of({{.name = "air-path", .value = 0.1, .unit = "%"}});

  const auto found = applied(plan, curve, presentations);

  EXPECT_NEAR(row_of(found.points.at(0), read_back_row).row.value, 9.95 - 9.94, 1e-12);
  const AppliedRow& air = row_of(found.points.at(0), air_path_row);
  EXPECT_NEAR(air.contribution, 0.5 * 0.006 / std::sqrt(3.0), 1e-12);  // the slope of a single contrast is 1
  EXPECT_TRUE(air.from_run);
  EXPECT_THAT(found.not_stated, ::testing::Not(Contains("air-path")));
  // The plan's own row is the only one where there is one.
  const auto stated = applied(own, curve, presentations);
  EXPECT_EQ(row_of(stated.points.at(0), "air-path").row.value, 0.1);
  for (const AppliedRow& row : stated.points.at(0).rows) EXPECT_NE(row.row.name, air_path_row);
  // Without the air it is missing, as it was.
  for (Presentation& shown : presentations) shown.air_transmittance.reset();
  EXPECT_THAT(applied(plan, curve, presentations).not_stated, Contains("air-path"));
}

TEST(CurveUncertainty, NeverLiesInsideTheStatisticalInterval) {
  // Of two degrees of freedom a second row makes k fall faster than u rises.
  TodPoint point = point_of(2, 2.5, 0.01);
  point.fit.clusters = 3;

  const auto found = applied(plan_of({{.name = "form", .value = 0.2, .unit = "%"}}), {"o", "s", {point}});

  EXPECT_LE(*found.points[0].expanded_mrad.low, *found.points[0].statistical_mrad.low);
  EXPECT_GE(*found.points[0].expanded_mrad.high, *found.points[0].statistical_mrad.high);
}

TEST(CurveUncertainty, LeavesAnOpenSideOpenAndMovesALimitWithoutAThreshold) {
  TodPoint point = point_of(2, 2.5, 0.01);
  point.fit.verdict = FitVerdict::above_range;
  point.fit.threshold.reset();
  point.fit.ci95 = {3.0, std::nullopt};

  const auto found = applied(plan_of({{.name = "form", .value = 1, .unit = "%"}}), {"o", "s", {point}});

  EXPECT_FALSE(found.points[0].expanded_mrad.high);
  EXPECT_NEAR(*found.points[0].expanded_mrad.low, 3.0 * std::exp(-z95 * 0.01), 1e-9);
  EXPECT_FALSE(found.points[0].combined);
}

TEST(CurveUncertainty, HoldsTheTruthAsOftenAsItSays) {
  const Plan plan =
      plan_of({{.name = "distance", .value = 30, .distribution = BudgetDistribution::rectangular, .unit = "mm"},
               {.name = "emissivity", .value = 2, .unit = "%"},
               {.name = "form", .value = 0.5, .unit = "%"}});
  TodCurve curve;
  for (const double contrast_k : {8.0, 2.0, 0.5})
    curve.points.push_back(point_of(contrast_k, 2 * std::pow(contrast_k, -0.5), 0.006));
  const double half = half_of(applied(plan, curve).points.at(1).expanded_mrad);

  constexpr int laboratories = 20000;
  int held = 0;
  const RandomStream random(1, "laboratories");
  for (int i = 0; i < laboratories; ++i) {
    const RandomStream own = random.sub(static_cast<std::uint64_t>(i));
    const auto normal = [&](std::uint64_t k) {
      return std::sqrt(-2 * std::log(own.uniform(2 * k))) * std::cos(2 * std::numbers::pi * own.uniform(2 * k + 1));
    };
    const double distance_m = 2 + 0.030 * (2 * own.uniform(100) - 1), contrast = 1 + 0.02 * normal(0);
    const double error = 0.006 * normal(1) + std::log(distance_m / 2) + 0.5 * std::log(contrast) + 0.005 * normal(2);
    held += std::abs(error) <= half ? 1 : 0;
  }

  // Four standard errors of a share of 0.95 and as much for what the draws are wrong by (0.35 % of the half-width).
  EXPECT_NEAR(held / double(laboratories), 0.95, 4 * std::sqrt(0.95 * 0.05 / laboratories) + 0.004);
}

Comparison comparison_at(double delta_t_k, double ratio, double u) {
  Comparison comparison;
  ComparisonPoint point;
  point.set_delta_t_k = delta_t_k;
  point.ratio = ratio;
  point.ratio_ci95 = {ratio * std::exp(-1.96 * u), ratio * std::exp(1.96 * u)};
  point.ratio_ci90 = {ratio * std::exp(-1.645 * u), ratio * std::exp(1.645 * u)};
  point.margin_percent = 10;
  point.verdict = comparison.verdict = ComparisonVerdict::equivalent;
  comparison.points = {point};
  return comparison;
}

TEST(CurveUncertainty, CancelsInTheRatioToTheTwinWhatBothShare) {
  BudgetRow row{.name = "distance", .value = 6, .unit = "%"};
  const TodCurve curve{"o", "s", {point_of(2, 2.5, 0.01)}};
  const auto comparison = std::optional(comparison_at(2, 1.01, 0.01));
  LimitsPlan limits;
  limits.equivalence_margin_percent = 10;
  const auto decision = [&](const CurveUncertainty& found) {
    return judge({.limits = limits, .curve = curve, .comparison = comparison, .uncertainty = &found})
        .demands.back()
        .decision;
  };

  const auto alone = applied(plan_of({row}), curve, {}, comparison);
  row.common = {BudgetCommon::twin};
  const auto shared = applied(plan_of({row}), curve, {}, comparison);

  EXPECT_EQ(alone.points[0].u_not_twin, alone.points[0].u_stated);
  EXPECT_EQ(shared.points[0].u_not_twin, 0);
  EXPECT_NEAR(shared.points[0].u_not_series, 0.06, 1e-12);
  EXPECT_EQ(decision(alone), VerdictKind::inconclusive);
  EXPECT_EQ(decision(shared), VerdictKind::pass);
}

TEST(CurveUncertainty, OfFewDegreesOfFreedomWidensRatiosLimitsAndMeasuresByStudentsT) {
  constexpr double t95 = 2.776445105, t90 = 2.131846786;  // of 4 degrees of freedom
  const std::vector<BudgetRow> rows{{.name = "emissivity", .value = 3, .degrees_of_freedom = 4, .unit = "%"},
                                    {.name = "camera-scale", .value = 3, .degrees_of_freedom = 4, .unit = "%"},
                                    {.name = "distance", .value = 3, .degrees_of_freedom = 4, .unit = "%"}};
  Plan plan = plan_of({rows[2]});
  TodPoint limit = point_of(2, 2.5, 0.01);
  limit.fit.threshold.reset();
  limit.fit.ci95.high.reset();
  const double low_mrad = *limit.fit.ci95.low;

  const auto ratio =
      applied(plan, {"o", "s", {point_of(2, 2.5, 0.01)}}, {}, comparison_at(2, 1, 1e-9)).points.at(0).ratio.value();
  const auto moved = applied(plan, {"o", "s", {limit}}).points.at(0).expanded_mrad;
  plan.uncertainty.rows = rows;

  EXPECT_NEAR(half_of(ratio.ci95), t95 * 0.03, 1e-6);
  EXPECT_NEAR(half_of(ratio.ci90), t90 * 0.03, 1e-6);
  EXPECT_NEAR(std::log(low_mrad / *moved.low), t95 * 0.03, 1e-9);
  EXPECT_NEAR(z95 * relative_u_of_scale(plan), t95 * 0.03, 1e-9);
  EXPECT_NEAR(z95 * relative_u_of_camera_scale(plan), t95 * 0.03, 1e-9);
  EXPECT_NEAR(z95 * relative_u_of_distance(plan), t95 * 0.03, 1e-9);
}

TEST(VerdictWithABudget, IsDecidedByTheExpandedInterval) {
  const TodCurve curve{"o", "s", {point_of(2, 2.5, 0.01)}};
  LimitsPlan limits;
  limits.acuity = {{2, 0.4 * std::exp(-0.03)}};  // three standard uncertainties of the trials below
  const auto found = applied(plan_of({{.name = "distance", .value = 2, .unit = "%"}}), curve);

  const Verdict without = judge({.limits = limits, .curve = curve, .comparison = std::nullopt});
  const Verdict with = judge({.limits = limits, .curve = curve, .comparison = std::nullopt, .uncertainty = &found});

  EXPECT_EQ(without.decision, VerdictKind::pass);
  EXPECT_EQ(with.decision, VerdictKind::inconclusive);
  EXPECT_THAT(with.reason, HasSubstr("form"));
  ASSERT_TRUE(with.demands[0].statistical);
  EXPECT_EQ(*with.demands[0].statistical->low, *without.demands[0].interval.low);
  EXPECT_LT(*with.demands[0].interval.low, *without.demands[0].interval.low);
  const auto back = verdict_from(verdict_json(with));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(verdict_json(*back).dump(), verdict_json(with).dump());
}

TEST(VerdictWithABudget, IsNothingElseWithoutOne) {
  const TodCurve curve{"o", "s", {point_of(2, 2.5, 0.01)}};

  EXPECT_FALSE(*curve_uncertainty(plan_of({}), curve, {}, std::nullopt));
}

}  // namespace
}  // namespace todbench
