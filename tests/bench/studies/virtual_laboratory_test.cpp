// SPDX-License-Identifier: GPL-3.0-or-later
// Short form of virtual_laboratory_study, and that laboratories err as they should.
#include "tests/bench/studies/virtual_laboratory.h"

#include "tests/bench/studies/virtual_laboratories.h"
#include "tests/support/temporary_folder.h"

namespace todbench::testing {
namespace {

/// Over 4000 laboratories the mean square of every error is that of its rows.
TEST(VirtualLaboratory, ErrsAsItsBudgetSays) {
  Plan plan = plan_of_laboratories(laboratory_design(), 1);
  plan.target.delta_t_k = {2, 0.2};
  constexpr int laboratories = 4000;
  double distance = 0, cut_outs = 0, scale = 0, relative = 0, kelvin = 0, both = 0, mean_k = 0;
  for (int i = 1; i <= laboratories; ++i) {
    const LaboratoryErrors e = drawn_errors(plan, 5, static_cast<std::uint64_t>(i));
    distance += e.distance_m.absolute * e.distance_m.absolute / laboratories;
    cut_outs += e.cut_outs_m.relative * e.cut_outs_m.relative / laboratories;
    scale += e.camera_scale.relative * e.camera_scale.relative / laboratories;
    relative += e.contrasts_k[0].relative * e.contrasts_k[0].relative / laboratories;
    kelvin += e.contrasts_k[0].absolute * e.contrasts_k[0].absolute / laboratories;
    mean_k += e.contrasts_k[0].absolute / laboratories;
    both += e.contrasts_k[0].absolute * e.contrasts_k[1].absolute / laboratories;
  }
  // The mean square of a normal error has a relative standard error of sqrt(2 / 4000) = 2.2 %, others have less.
  constexpr double four_errors = 0.09;
  const auto near = [](double found, double expected) { return std::abs(found / expected - 1) < four_errors; };
  EXPECT_TRUE(near(distance, (4e-6 + 225e-6) / 3)) << distance;
  EXPECT_TRUE(near(cut_outs, 9e-6)) << cut_outs;
  EXPECT_TRUE(near(scale, 2.25e-4)) << scale;
  EXPECT_TRUE(near(relative, (1e-4 + 0.25e-4) / 3)) << relative;
  EXPECT_TRUE(near(kelvin, 64e-6 + 25e-6 / 3 + 9e-6 + 16e-6 / 2)) << kelvin;
  EXPECT_NEAR(mean_k, 0, 4 * std::sqrt(kelvin / laboratories));
  EXPECT_TRUE(near(both, 64e-6 + 25e-6 / 3 + 9e-6)) << "the stability is another one at every contrast";
}

TEST(VirtualLaboratory, HoldsTheTruthWhereTrialsAloneDoNot) {
  GradedDesign design = laboratory_design();
  design.delta_t_k = {1.93, 0.23};
  design.phases = 1;
  const TemporaryFolder folder;
  LaboratoryRecord record((folder.path() / "points").string());
  constexpr std::uint64_t laboratories = 2;
  run_laboratories(record, design, plan_of_laboratories(design, 700), laboratories);
  // As of virtual_laboratory_study: standard error 0.1 %.
  const std::map<double, double> truth{{1.93, 2.1373}, {0.23, 3.4384}};
  for (const double contrast : design.delta_t_k) {
    const auto points = points_at(record.points(), contrast);
    const LaboratorySummary s = summary_of(points, truth.at(contrast));
    ASSERT_EQ(s.laboratories, static_cast<int>(laboratories));
    EXPECT_GE(s.coverage, 0.5) << contrast << ": neither of two has a probability of 0.25 % at 95 %";
    for (const LaboratoryPoint& p : points) {
      EXPECT_LT(p.low, p.statistical_low) << contrast;
      EXPECT_GT(p.high, p.statistical_high) << contrast;
      EXPECT_LT(std::abs(normalised_error(p, points[0])), 1.6) << contrast << ": beyond three standard uncertainties";
    }
  }
  EXPECT_EQ(LaboratoryRecord((folder.path() / "points").string()).points().size(), 2 * laboratories);
}

TEST(VirtualLaboratory, ComparesByTheUncertaintiesThatFaceEachOther) {
  const LaboratoryPoint a{.s75_mrad = 1, .low = std::exp(-0.03), .high = std::exp(0.04)};
  const LaboratoryPoint b{.s75_mrad = std::exp(0.1), .low = std::exp(0.1 - 0.03), .high = std::exp(0.2)};
  EXPECT_NEAR(normalised_error(a, b), -0.1 / 0.05, 1e-12);
  EXPECT_NEAR(normalised_error(b, a), 0.1 / 0.05, 1e-12);
}

/// Errors of a known normal law: the shares that the rules get wrong are the stated ones.
TEST(VirtualLaboratory, CountsTheRisksOfTheRules) {
  const RandomStream random(3, "risks");
  std::vector<LaboratoryPoint> points;
  constexpr double u = 0.01, k = 1.959964;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const double s75 = 2 * std::exp(u * random.normal(i));
    points.push_back({.s75_mrad = s75, .low = s75 * std::exp(-k * u), .high = s75 * std::exp(k * u), .u = u});
  }
  const RuleOutcome simple = outcome_of(points, 2, ConformityRule::simple, 4 * u);
  // Of little prior knowledge over +- 4 u: E|z| / 2 u of 4 u on each side, whose standard deviation is 0.58 u.
  const double tolerance = 4 * 0.58 / 4 / std::sqrt(2000.0);
  EXPECT_NEAR(simple.wrong_if_accepted, 0.3989 / 4, tolerance);
  EXPECT_NEAR(simple.stated_if_accepted, simple.wrong_if_accepted, tolerance);
  EXPECT_NEAR(simple.stated_if_rejected, simple.wrong_if_rejected, tolerance);
  const RuleOutcome guarded = outcome_of(points, 2, ConformityRule::guarded_acceptance_and_rejection, 4 * u);
  EXPECT_NEAR(guarded.stated_if_accepted, guarded.wrong_if_accepted, 0.004);
  EXPECT_NEAR(accepted_on_the_limit(points, 2), 0.025, 4 * std::sqrt(0.025 * 0.975 / 2000));
}

}  // namespace
}  // namespace todbench::testing
