// SPDX-License-Identifier: GPL-3.0-or-later
// Acuity under recorded noise, on recordings whose answer is known.
#include "bench/studies/real_noise_study.h"

#include <gtest/gtest.h>

#include <cmath>

#include "acquisition/base/rng.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/resources.h"
#include "tests/sim_devices/reference.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

/// A fixed scene with pixel noise of sd `white` and column noise of sd `column`, new in every frame.
std::vector<cv::Mat1f> recording(int frames, double white, double column, std::uint64_t seed) {
  std::vector<cv::Mat1f> out;
  for (int k = 0; k < frames; ++k) {
    cv::Mat1f frame(120, 160);
    const RandomStream stream = RandomStream(seed, "real_noise_test").sub(static_cast<std::uint64_t>(k));
    stream.fill_normal(std::span(frame.ptr<float>(), frame.total()));
    for (int y = 0; y < frame.rows; ++y) {
      for (int x = 0; x < frame.cols; ++x) {
        const double columns = column * static_cast<double>(stream.sub(1).normal(static_cast<std::uint64_t>(x)));
        frame(y, x) = static_cast<float>(3000 + 5 * std::sin(x / 7.0) + 0.1 * y +
                                         white * static_cast<double>(frame(y, x)) + columns);
      }
    }
    out.push_back(frame);
  }
  return out;
}

RealNoiseOptions short_study() {
  return {.contrast_over_noise = {3.3}, .draws = 600};
}

TEST(ThreeDNoise, FindsTheComponentsThatWerePutIn) {
  const auto found = three_d_noise(recording(40, 1, 0.5, 1));

  // Column noise: 39 * 159 degrees of freedom, so its sd is known to 1 / sqrt(2 * 6201) = 0.9 %; pixel noise to 0.1 %.
  // The scene alone (no noise) has vh = 0 because it is a sum of rows and columns.
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_NEAR(found->tvh, 1, 0.005);
  EXPECT_NEAR(found->th, 0.5, 0.02);
  EXPECT_LT(found->tv, 0.02);
  EXPECT_LT(found->t, 0.06);  // its estimate has a standard error of 0.5 sqrt(2 / 39) / sqrt(160) in the variance / sd
  EXPECT_NEAR(found->h, 5 / std::sqrt(2.0), 0.2);
  EXPECT_NEAR(found->v, 0.1 * std::sqrt((120.0 * 120 + 120) / 12), 0.01);  // sd of a ramp of 120 steps with n - 1
}

TEST(RecordedNoise, IsThatOfSingleFramesWhateverTheLengthOfABlock) {
  const auto frames = recording(40, 2, 0, 2);

  for (const int block : {2, 5, 10, 40}) {
    const auto noise = recorded_noise(frames, block);
    ASSERT_TRUE(noise) << noise.error().message;
    EXPECT_NEAR(noise->temporal_noise, 2, 0.02) << block;  // 384 000 values: 0.1 %, of which blocks of 2 use a half
    EXPECT_DOUBLE_EQ(noise->usable_share, 1);
  }
}

TEST(RealNoiseStudy, WhiteNoiseGivesTheAcuityOfWhiteNoise) {
  TemplateObserver observer({}, triangle_alternatives());
  int contained = 0;

  for (const std::uint64_t seed : {11, 12, 13, 14}) {
    const auto noise = recorded_noise(recording(40, 0.7, 0, seed), 10);
    ASSERT_TRUE(noise) << noise.error().message;
    const auto found = real_noise_study(*noise, test::sc2000(), observer, short_study());
    ASSERT_TRUE(found) << found.error().message;
    const NoiseAcuity& point = found->front();
    contained += *point.ratio_ci95.low <= 1 && *point.ratio_ci95.high >= 1 ? 1 : 0;
    EXPECT_NE(point.acuity_ratio, 1.0);                // two noises, not one
    EXPECT_NEAR(point.template_noise_ratio, 1, 0.08);  // 600 draws of about 3 independent numbers: 2 %
    EXPECT_NEAR(point.pixel_share, 1, 0.02);
  }

  // Four intervals of 95 %: three or more contain 1 with a probability of 98.6 %; the seeds are fixed.
  EXPECT_GE(contained, 3);
}

TEST(RealNoiseStudy, ColumnNoiseHasTheVarianceThatItsCovarianceGivesAndTheAcuityThatFollows) {
  TemplateObserver observer({}, triangle_alternatives());
  const double column = 1, white = 0.5;
  const auto noise = recorded_noise(recording(60, white, column, 21), 10);
  ASSERT_TRUE(noise) << noise.error().message;

  const auto found = real_noise_study(*noise, test::sc2000(), observer, short_study());

  // Covariance of column noise between two pixels: column^2 in the same column, else 0; so a template d has the
  // variance white^2 |d|^2 + column^2 sum over columns of (sum of d)^2.
  ASSERT_TRUE(found) << found.error().message;
  const NoiseAcuity& point = found->front();
  const int index = static_cast<int>(std::lround(std::log(point.real.s75_pitch) / std::log(1.08)));
  const auto bank = observer.bank(std::pow(1.08, index), 1);
  ASSERT_TRUE(bank) << bank.error().message;
  double norm = 0, columns = 0;
  for (int a = 0; a < 4; ++a) {
    for (int b = a + 1; b < 4; ++b) {
      const cv::Mat1f d = (*bank)->image(a, (*bank)->central_place()) - (*bank)->image(b, (*bank)->central_place());
      norm += cv::norm(d, cv::NORM_L2SQR);
      for (int x = 0; x < d.cols; ++x) columns += std::pow(cv::sum(d.col(x))[0], 2);
    }
  }
  const double expected =
      std::sqrt((white * white + column * column * columns / norm) / (white * white + column * column));
  EXPECT_NEAR(point.template_noise_ratio, expected, 0.08 * expected);  // 600 windows that share columns: about 3 %
  EXPECT_NEAR(point.correlated_share, 0, 0.2 * expected * expected);   // rows and columns explain all of it
  // The acuity goes with the noise in the templates, within the accuracy of that rule (10 %).
  EXPECT_NEAR(point.acuity_ratio / point.predicted_ratio, 1, 0.1);
}

TEST(RealNoiseStudy, IsThatOfTheRecordingWhateverGainAndOffsetItsCountsHave) {
  const auto frames = recording(20, 0.7, 0.3, 31);
  std::vector<cv::Mat1f> scaled;
  for (const cv::Mat1f& frame : frames) scaled.push_back(4 * frame - 700);
  const auto plain = recorded_noise(frames, 10), other = recorded_noise(scaled, 10);
  ASSERT_TRUE(plain && other);
  EXPECT_NEAR(other->temporal_noise / plain->temporal_noise, 4, 1e-3);
  for (const std::string& name : resource_names(ResourceKind::observer)) {
    const auto spec = load_observer(name);
    if (!spec) continue;  // one with an eye judges a display, and a recording states none
    TemplateObserver observer(*spec, triangle_alternatives());
    const RealNoiseOptions options{.contrast_over_noise = {3.3}, .draws = 150};
    const auto found = real_noise_study(*plain, test::sc2000(), observer, options),
               behind = real_noise_study(*other, test::sc2000(), observer, options);

    ASSERT_TRUE(found && behind) << name;
    // Single precision at 12000 counts: 1e-3 counts beside a noise of 3.
    EXPECT_NEAR(behind->front().real.s75_pitch / found->front().real.s75_pitch, 1, 2e-3) << name;
    EXPECT_NEAR(behind->front().acuity_ratio / found->front().acuity_ratio, 1, 2e-3) << name;
  }
}

TEST(RecordedNoise, RefusesWhatHoldsNoNoise) {
  EXPECT_FALSE(recorded_noise(recording(3, 1, 0, 1), 10).has_value());
  EXPECT_FALSE(recorded_noise(std::vector<cv::Mat1f>(10, cv::Mat1f(20, 20, 5.0F)), 10).has_value());
}

}  // namespace
}  // namespace todbench
