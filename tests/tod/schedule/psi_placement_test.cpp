// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/schedule/psi_placement.h"

#include "tests/tod/schedule/psi_support.h"
#include "tod/psychometric/psychometric_model.h"

namespace todbench {
namespace {

using testing::psi_run;
using testing::psi_study;

PsiOptions wide() {
  PsiOptions options;
  options.first_size = 0.2;
  options.last_size = 5;
  return options;
}

TEST(PsiPlacement, StartsNearTheMiddleOfThePrior) {
  const PsiPlacement placement(wide(), RandomStream(3, "psi"));

  EXPECT_NEAR(placement.mean_ln_threshold(), 0, 1e-9);
  EXPECT_GT(placement.next(), 0.5);
  EXPECT_LT(placement.next(), 2.5);
}

TEST(PsiPlacement, SurvivesOneSlipAtAHugeSize) {
  PsiPlacement placement(wide(), RandomStream(3, "psi"));

  placement.observe(1000, 0, 1);

  EXPECT_TRUE(std::isfinite(placement.mean_ln_threshold()));
  EXPECT_GT(placement.sd_ln_threshold(), 0.5);  // a lapse explains it: nothing has been learnt
}

TEST(PsiPlacement, ExpectsMostOfSizesNearTheThreshold) {
  PsiPlacement now(wide(), RandomStream(3, "psi"));

  now.observe(1, 30, 40);

  EXPECT_LT(now.expected_gain(0.05), 1e-3);  // pure chance tells nothing
  EXPECT_LT(now.expected_gain(500), 1e-3);   // neither does certainty
  EXPECT_GT(now.expected_gain(1.1), 5 * now.expected_gain(3));
}

TEST(PsiPlacement, FindsAThresholdThatIsFarFromTheMiddleOfThePrior) {
  for (const double ln_threshold : {-1.4, 1.4}) {
    PsiPlacement placement(wide(), RandomStream(5, "psi"));
    const RandomStream answers(6, "answers");
    for (std::uint64_t i = 0; i < 200; ++i) {
      const double size = placement.next();
      const double right = psychometric(PsychometricForm::size, size, std::exp(ln_threshold), 3.5, 0);
      placement.observe(size, answers.uniform(i) < right ? 1 : 0, 1);
    }
    // 200 trials: the bound is 3.2 %; four times that.
    EXPECT_NEAR(placement.mean_ln_threshold(), ln_threshold, 0.13);
    EXPECT_LT(placement.sd_ln_threshold(), 0.08);
  }
}

TEST(PsiPlacement, KeepsItsGridFinerThanItsKnowledgeForThousandsOfTrials) {
  PsiPlacement placement(wide(), RandomStream(5, "psi"));

  for (int i = 0; i < 50; ++i) placement.observe(1, 7500, 10000);

  EXPECT_NEAR(placement.mean_ln_threshold(), 0, 0.005);
  EXPECT_LT(placement.sd_ln_threshold(), 0.002);
}

TEST(PsiPlacement, ChoosesTheSameSizesForTheSameAnswers) {
  const auto a = psi_run({.trials = 60}, 4), b = psi_run({.trials = 60}, 4);

  ASSERT_EQ(a.levels.size(), b.levels.size());
  for (std::size_t i = 0; i < a.levels.size(); ++i) EXPECT_EQ(a.levels[i].size, b.levels[i].size);
}

/// Short form of the study.
TEST(PsiPlacement, IsThreeQuartersAsEfficientAsTheBoundAtAHundredAndSixtyTrials) {
  constexpr int runs = 120;

  const auto study = psi_study({.trials = 160}, runs);

  // The variance of a variance is 2 / runs: 13 % here; the study with 2000 runs finds 0.8.
  EXPECT_GT(study.efficiency, 0.8 - 3.5 * 0.8 * std::sqrt(2.0 / runs));
  EXPECT_LT(std::abs(study.bias), 4 * study.sd / std::sqrt(runs) + 0.005);
  EXPECT_NEAR(study.posterior, 0.95, 3.5 * std::sqrt(0.95 * 0.05 / runs) + 0.01);
}

}  // namespace
}  // namespace todbench
