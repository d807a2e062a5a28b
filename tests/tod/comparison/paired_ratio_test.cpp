// SPDX-License-Identifier: GPL-3.0-or-later
// A camera against its twin by common phases.
#include "tod/comparison/paired_ratio.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/tod/psychometric/graded_support.h"
#include "tod/psychometric/twin_shape.h"

namespace todbench {
namespace {

using testing::GradedBench;

/// Camera `ratio` times as acute as the twin. What presentations and places have in common moves both, by a scatter of
/// their own that is 6 to 9 times as small.
std::vector<PairedAnswer> pairs_of(double ratio, std::uint64_t seed, double own = 0.1, int presentations = 24) {
  const GradedBench twin{.threshold = 2, .presentations = presentations};
  const auto answers = testing::graded_answers_of(twin, seed);
  const RandomStream stream(seed, "pairs");
  std::vector<PairedAnswer> pairs;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const double size = answers[i].size;
    const double mu = testing::true_proportion(size, 2, 1), mu_camera = testing::true_proportion(size, 2 / ratio, 1);
    const auto near = [own](double mean, double common, double z) {
      const double room = std::min(mean, 1 - mean);
      return mean + room * (0.85 * common + own * z);
    };
    // -1 to 1; what the presentation does to both.
    const double common = (answers[i].probability_correct - mu) / std::min(mu, 1 - mu);
    PairedAnswer pair{answers[i], near(mu, common, 2 * stream.sub(1).uniform(i) - 1), 1e-4};
    pair.camera.probability_correct = near(mu_camera, common, 2 * stream.sub(2).uniform(i) - 1);
    pairs.push_back(pair);
  }
  return pairs;
}

const ProportionTable& table() {
  static const ProportionTable found = testing::table_of({}, 0, 1);
  return found;
}

TEST(PairedRatio, CancelsWhatPresentationsHaveInCommon) {
  int equivalent = 0, different = 0, covered = 0;
  double sum = 0, squares = 0, stated = 0, unpaired = 0;
  constexpr int seeds = 300;
  for (int seed = 1; seed <= seeds; ++seed) {
    const auto pairs = pairs_of(1, static_cast<std::uint64_t>(seed));
    const auto found = paired_ratio(pairs, table(), false, 24, 3);
    ASSERT_TRUE(found) << found.error().message;
    const double ln_ratio = std::log(found->ratio);
    sum += ln_ratio;
    squares += ln_ratio * ln_ratio;
    stated += found->se_ln_ratio;
    covered += *found->ci95.low <= 1 && 1 <= *found->ci95.high ? 1 : 0;
    equivalent += found->verdict == ComparisonVerdict::equivalent ? 1 : 0;
    different += found->p_difference < 0.05 ? 1 : 0;
    EXPECT_EQ(found->interval, IntervalKind::set_ups);
    std::vector<GradedAnswer> camera;
    for (const PairedAnswer& pair : pairs) camera.push_back(pair.camera);
    const auto alone = twin_shape_estimate(camera, table(), false);
    ASSERT_TRUE(alone);
    unpaired += std::pow(alone->ln_threshold - std::log(2.0), 2);
  }
  const double scatter = std::sqrt(squares / seeds);
  EXPECT_LT(std::abs(sum / seeds), 4 * scatter / std::sqrt(seeds));
  EXPECT_NEAR(stated / seeds / scatter, 1, 4 / std::sqrt(2.0 * seeds) + 0.04) << "t with 7 degrees: a root is low";
  EXPECT_GT(unpaired / seeds, 10 * scatter * scatter) << "0.85 / 0.14 squared, and more";
  // Four standard errors of a share of 300.
  EXPECT_NEAR(covered / 300.0, 0.95, 0.05);
  EXPECT_NEAR(different / 300.0, 0.05, 0.05);
  EXPECT_GT(equivalent, 295);
}

TEST(PairedRatio, FindsEquivalenceAtTheMarginAsOftenAsTheTestMay) {
  int equivalent = 0;
  double mean = 0;
  for (int seed = 1; seed <= 300; ++seed) {
    const auto found = paired_ratio(pairs_of(1.03, static_cast<std::uint64_t>(seed)), table(), false, 24, 3);
    ASSERT_TRUE(found);
    equivalent += found->verdict == ComparisonVerdict::equivalent ? 1 : 0;
    mean += std::log(found->ratio) / 300;
  }
  EXPECT_NEAR(equivalent / 300.0, 0.05, 0.05);
  EXPECT_NEAR(mean, std::log(1.03), 3e-4) << "nothing of the ratio is lost";
}

TEST(PairedRatio, IsThatOfTheThresholdsAlsoWithAWrongFunctionAndAnotherSlope) {
  const GradedBench other{.threshold = 2.1, .slope_ratio = 1.1};
  const ProportionTable wrong = testing::table_of(other, 0, 1);
  const auto found = paired_ratio(pairs_of(1, 5), wrong, true, 24, 3);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->ratio, 1, 4 * found->se_ln_ratio) << "an error of the function is in both";
  const auto apart = paired_ratio(pairs_of(1.2, 5), table(), false, 24, 3);
  ASSERT_TRUE(apart);
  EXPECT_EQ(apart->verdict, ComparisonVerdict::different);
  EXPECT_NEAR(apart->ratio, 1.2, 4 * 1.2 * apart->se_ln_ratio);
}

TEST(PairedRatio, StatesTheTwinsShareOfTheVariance) {
  auto pairs = pairs_of(1, 7);
  const auto found = paired_ratio(pairs, table(), false, 24, 3);
  for (PairedAnswer& pair : pairs) pair.twin_variance = 0;
  const auto without = paired_ratio(pairs, table(), false, 24, 3);
  ASSERT_TRUE(found && without);
  EXPECT_GT(found->twin_share, 0);
  EXPECT_EQ(without->twin_share, 0);
  EXPECT_EQ(found->se_ln_ratio, without->se_ln_ratio) << "it is in the scatter already";
}

TEST(PairedRatio, OfTwoFunctionsHasBothThresholdsAndTheErrorsOfBoth) {
  const auto pairs = pairs_of(1, 7);
  ProportionTable other = table();
  for (double& size : other.size_mrad) size *= 1.05;
  const auto one = paired_ratio(pairs, table(), false, 24, 3);

  const auto two = paired_ratio(pairs, table(), false, 24, 3, {}, OwnFunctions{table(), 0.003 * 0.003});
  const auto stretched = paired_ratio(pairs, table(), false, 24, 3, {}, OwnFunctions{other, 0});

  ASSERT_TRUE(one && two && stretched);
  EXPECT_EQ(two->ratio, one->ratio);
  EXPECT_NEAR(two->se_ln_ratio, std::hypot(one->se_ln_ratio, 0.003), 1e-12);
  // A stretched function is the same one: the size is fitted.
  EXPECT_NEAR(stretched->ratio, one->ratio, 1e-6);
}

TEST(PairedRatio, HoldsTheScatterOfTheContrastOnceWhateverTheClusters) {
  constexpr ContrastScatter contrast{.se_ln_acuity = 0.02, .degrees_of_freedom = 2.0};
  const auto of_one_set_up = pairs_of(1, 3, 0.1, 3), of_many = pairs_of(1, 3);
  const auto without = paired_ratio(of_one_set_up, table(), false, 24, 3);
  const auto with = paired_ratio(of_one_set_up, table(), false, 24, 3, contrast);
  ASSERT_TRUE(without && with);
  EXPECT_NEAR(with->se_ln_ratio, std::hypot(without->se_ln_ratio, 0.02), 1e-12);
  EXPECT_EQ(with->ratio, without->ratio);
  EXPECT_LE(with->degrees_of_freedom, without->degrees_of_freedom + 2 + 1e-9) << "Welch and Satterthwaite";
  EXPECT_GT(with->degrees_of_freedom, std::min(without->degrees_of_freedom, 2.0));

  const auto over_set_ups = paired_ratio(of_many, table(), false, 24, 3, contrast);
  ASSERT_TRUE(over_set_ups);
  EXPECT_EQ(over_set_ups->interval, IntervalKind::set_ups);
  const double alone = paired_ratio(of_many, table(), false, 24, 3)->se_ln_ratio;
  EXPECT_EQ(over_set_ups->se_ln_ratio, alone);
  // What all set-ups have in common is in no scatter over them.
  const ContrastScatter common{.se_ln_acuity = 0.02, .shared_se_ln_acuity = 0.015, .degrees_of_freedom = 7.0};
  EXPECT_NEAR(paired_ratio(of_many, table(), false, 24, 3, common)->se_ln_ratio, std::hypot(alone, 0.015), 1e-12);
  EXPECT_NEAR(paired_ratio(of_one_set_up, table(), false, 24, 3, common)->se_ln_ratio,
              std::hypot(without->se_ln_ratio, 0.02), 1e-12);
}

TEST(PairedRatio, RefusesWhatHasNoVariance) {
  const auto pairs = pairs_of(1, 3, 0.1, 3);  // one set-up
  const auto found = paired_ratio(pairs, table(), false, 24, 3);
  ASSERT_TRUE(found) << "presentations and places are left";
  EXPECT_EQ(found->interval, IntervalKind::two_way);
  auto same = pairs_of(1, 3);
  for (PairedAnswer& pair : same) pair.twin_probability = pair.camera.probability_correct;
  EXPECT_FALSE(paired_ratio(same, table(), false, 24, 3));
  EXPECT_FALSE(paired_ratio({}, table(), false, 24, 3));
  EXPECT_FALSE(paired_ratio(pairs, table(), false, 24, 0));
  auto broken = pairs_of(1, 3);
  broken.front().twin_probability = std::nan("");
  EXPECT_FALSE(paired_ratio(broken, table(), false, 24, 3));
}

TEST(PairedRatio, OfTwoCamerasIsTheRatioOfBothToTheSameTwin) {
  const auto a = paired_ratio(pairs_of(1.04, 11), table(), false, 24, 3);
  const auto b = paired_ratio(pairs_of(0.99, 12), table(), false, 16, 3);
  ASSERT_TRUE(a && b);
  const RatioOfPairs ab = ratio_of_paired(*a, *b, 3), ba = ratio_of_paired(*b, *a, 3);
  EXPECT_NEAR(ab.ratio, a->ratio / b->ratio, 1e-12);
  EXPECT_NEAR(ab.ratio * ba.ratio, 1, 1e-12);
  EXPECT_NEAR(ab.se_ln_ratio, std::hypot(a->se_ln_ratio, b->se_ln_ratio), 1e-15);
  EXPECT_EQ(ab.verdict, ba.verdict);
  EXPECT_NEAR(*ab.ci95.low * *ba.ci95.high, 1, 1e-12);
  EXPECT_EQ(ab.draws, 16);
  EXPECT_GT(ab.degrees_of_freedom, a->degrees_of_freedom);
}

TEST(PairedRatio, DecidesNothingWhereAThresholdIsUnfitForADecision) {
  Comparison comparison{.points = {{.set_delta_t_k = 16.9, .withheld = true}, {.set_delta_t_k = 0.23}},
                        .adequacy = Adequacy{{{FindingKind::clipping, 0.79, 0, "pixels are saturated", true}}}};
  add_paired(comparison, 0, {.ratio = 1.001, .verdict = ComparisonVerdict::equivalent});
  add_paired(comparison, 1, {.ratio = 1.001, .verdict = ComparisonVerdict::equivalent});

  EXPECT_EQ(comparison.points[0].paired->verdict, ComparisonVerdict::inconclusive);
  EXPECT_EQ(comparison.points[1].paired->verdict, ComparisonVerdict::equivalent);
  EXPECT_EQ(comparison.verdict, ComparisonVerdict::inconclusive);
  EXPECT_EQ(as_decided(comparison).points[0].verdict, ComparisonVerdict::inconclusive);
}

TEST(PairedRatio, DecidesTheComparison) {
  Comparison comparison;
  comparison.points = {{.set_delta_t_k = 16.9, .ratio = 1.02, .verdict = ComparisonVerdict::inconclusive},
                       {.set_delta_t_k = 0.23, .ratio = 1.01, .verdict = ComparisonVerdict::equivalent}};
  EXPECT_FALSE(decided_by_pairs(comparison));
  add_paired(comparison, 0, {.ratio = 1.001, .verdict = ComparisonVerdict::equivalent});
  EXPECT_EQ(comparison.verdict, ComparisonVerdict::equivalent);
  EXPECT_FALSE(decided_by_pairs(comparison));
  add_paired(comparison, 1, {.ratio = 0.9, .verdict = ComparisonVerdict::different});
  EXPECT_TRUE(decided_by_pairs(comparison));
  EXPECT_EQ(comparison.verdict, ComparisonVerdict::different);
  const Comparison decided = as_decided(comparison);
  EXPECT_EQ(decided.points[1].ratio, 0.9);
  EXPECT_EQ(comparison.points[1].ratio, 1.01);
  add_finding(comparison, {.kind = FindingKind::identity, .sentence = "the same", .unfit = true});
  EXPECT_EQ(comparison.points[0].paired->verdict, ComparisonVerdict::inconclusive);
}

}  // namespace
}  // namespace todbench
