// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/temporal_noise.h"

#include <gmock/gmock.h>

#include <cmath>

#include "acquisition/base/rng.h"

namespace todbench {
namespace {

using ::testing::ElementsAre;

constexpr int side = 40;

/// Noise of first order, sd 2, with the pictures' own pattern and a drift per frame that differs from pixel to pixel.
std::vector<TimedPicture> sequence(int frames, double rho, double drift = 0) {
  const RandomStream stream(7, "temporal noise test");
  cv::Mat1f pattern(side, side), slope(side, side), state(side, side), fresh(side, side);
  const auto draw = [&](cv::Mat1f& into, std::uint64_t index) {
    stream.sub(index).fill_normal(std::span(into.ptr<float>(), into.total()));
  };
  draw(pattern, 1);
  draw(slope, 2);
  draw(state, 3);
  std::vector<TimedPicture> out;
  for (int k = 0; k < frames; ++k) {
    if (k > 0) {
      draw(fresh, static_cast<std::uint64_t>(10 + k));
      state = state * rho + fresh * std::sqrt(1 - rho * rho);
    }
    const cv::Mat1f picture = 1000 + 30 * pattern + 2 * state + drift * k * slope;
    out.push_back({picture.clone(), static_cast<std::uint64_t>(k), 0});
  }
  return out;
}

/// Relative standard error of a root mean square over so many values; 2: for what correlates in time.
double error_of(double values, double excess = 2) {
  return excess / std::sqrt(2 * values);
}

class NoiseOfFirstOrder : public ::testing::TestWithParam<double> {};

TEST_P(NoiseOfFirstOrder, HasTheStructureFunctionAndCorrelationOfItsTheory) {
  const double rho = GetParam();
  const auto pictures = sequence(200, rho);

  const auto noise = temporal_noise(pictures);

  ASSERT_TRUE(noise) << noise.error().message;
  // Independent values: pixels times frames over the time that the noise remembers.
  const double values = side * side * 128 * (1 - rho) / (1 + rho);
  EXPECT_NEAR(noise->successive / (2 * std::sqrt(1 - rho)), 1, 4 * error_of(side * side * 128.0));
  ASSERT_EQ(noise->lags.size(), 64u);
  for (std::size_t i = 0; i < noise->lags.size(); ++i) {
    const double expected = 2 * std::sqrt(1 - std::pow(rho, noise->lags[i]));
    EXPECT_NEAR(noise->structure[i] / expected, 1, 4 * error_of(values)) << "lag " << noise->lags[i];
  }
  ASSERT_TRUE(noise->lag1_correlation);
  EXPECT_NEAR(*noise->lag1_correlation, rho, 4 * 2 * error_of(values) * (1 - rho * rho));
  EXPECT_NEAR(noise->whole_to_successive, std::sqrt((1 - std::pow(rho, 64)) / (1 - rho)),
              4 * error_of(values) / std::sqrt(1 - rho));
}

INSTANTIATE_TEST_SUITE_P(All, NoiseOfFirstOrder, ::testing::Values(0.0, 0.5, 0.8, 0.9));

TEST(TemporalNoise, ComparesExposuresAndNotPlacesInTheList) {
  auto pictures = sequence(200, 0.8);
  const auto all = temporal_noise(pictures);
  // Every third exposure is missing.
  std::erase_if(pictures, [](const TimedPicture& p) { return p.sequence % 3 == 2; });

  const auto some = temporal_noise(pictures);

  ASSERT_TRUE(all && some);
  EXPECT_NEAR(some->successive / all->successive, 1, 4 * error_of(side * side * 66.0));
  EXPECT_NEAR(*some->lag1_correlation, *all->lag1_correlation, 0.03);
}

TEST(TemporalNoise, OfEverySecondExposureStillTellsTheCorrelationOfSuccessiveOnes) {
  auto pictures = sequence(200, 0.8);
  std::erase_if(pictures, [](const TimedPicture& p) { return p.sequence % 2 == 1; });

  const auto noise = temporal_noise(pictures);

  ASSERT_TRUE(noise) << noise.error().message;
  EXPECT_EQ(noise->lags.front(), 2);
  EXPECT_NEAR(*noise->lag1_correlation, 0.8, 0.03);
}

TEST(TemporalNoise, DoesNotCompareAcrossACorrection) {
  auto pictures = sequence(120, 0);
  for (std::size_t k = 50; k < pictures.size(); ++k) {
    pictures[k].picture += 40;
    pictures[k].segment = 1;
  }

  const auto noise = temporal_noise(pictures);

  ASSERT_TRUE(noise) << noise.error().message;
  for (const double value : noise->structure) EXPECT_NEAR(value, 2, 2 * 4 * error_of(side * side * 6.0));
}

/// Pictures whose noise is larger by `factor` in the second half.
std::vector<TimedPicture> halves(int frames, double factor, bool whole_rows, std::uint64_t seed) {
  const RandomStream stream(seed, "halves");
  std::vector<TimedPicture> out;
  for (int k = 0; k < frames; ++k) {
    cv::Mat1f picture(side, side);
    stream.sub(static_cast<std::uint64_t>(k)).fill_normal(std::span(picture.ptr<float>(), picture.total()));
    if (whole_rows) cv::repeat(cv::Mat1f(picture.col(0).clone()), 1, side, picture);
    out.push_back({cv::Mat1f(picture * (k < frames / 2 ? 1 : factor)), static_cast<std::uint64_t>(k), 0});
  }
  return out;
}

TEST(TemporalNoise, SaysThatItChangesBetweenTheHalves) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    EXPECT_TRUE(temporal_noise(halves(64, 1.3, false, seed))->changes) << seed;
    EXPECT_TRUE(temporal_noise(halves(16, 2, true, seed))->changes) << seed;
    EXPECT_TRUE(temporal_noise(halves(16, 0.5, false, seed))->changes) << seed;
  }
}

TEST(TemporalNoise, DoesNotSayThatConstantNoiseChanges) {
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    const int frames = seed % 2 == 0 ? 10 : 64;
    EXPECT_FALSE(temporal_noise(halves(frames, 1, false, seed))->changes) << seed;
    EXPECT_FALSE(temporal_noise(halves(frames, 1, true, seed))->changes) << seed;
  }
  for (const double rho : {0.5, 0.9}) EXPECT_FALSE(temporal_noise(sequence(200, rho))->changes) << rho;
}

TEST(TemporalNoise, LeavesOutPixelsThatSeeSceneOrNeverChange) {
  auto pictures = sequence(100, 0);
  for (auto& p : pictures) {
    p.picture(cv::Rect(0, 0, 8, side)) += 5.0 * (p.sequence % 7);
    p.picture(cv::Rect(30, 0, 4, side)) = 4095;
  }

  const auto noise = temporal_noise(pictures);

  ASSERT_TRUE(noise) << noise.error().message;
  EXPECT_NEAR(noise->usable_share, 28.0 / 40, 0.01);
  EXPECT_NEAR(noise->successive, 2, 2 * 4 * error_of(28.0 * side * 99));
}

TEST(TemporalNoise, TakesSlowDriftNeitherForNoiseNorForMemory) {
  // A fiftieth of the noise in each frame, four times the noise from the first to the last.
  const auto noise = temporal_noise(sequence(200, 0, 2 * 0.02));

  ASSERT_TRUE(noise) << noise.error().message;
  EXPECT_NEAR(noise->successive, 2, 0.01);
  EXPECT_LT(std::abs(*noise->lag1_correlation), 0.02);
  EXPECT_GT(noise->structure.back(), 2.5);  // it is in the structure function
}

TEST(TemporalNoise, TakesNeitherDriftNorBounceOfWholeFramesForMemory) {
  auto drifting = sequence(100, 0), bouncing = sequence(60, 0.5);
  for (auto& p : drifting) p.picture += 1.5 * static_cast<double>(p.sequence);
  for (auto& p : bouncing) p.picture += 4.0 * std::sin(2.3 * static_cast<double>(p.sequence * p.sequence));

  const auto drift = temporal_noise(drifting), bounce = temporal_noise(bouncing);

  ASSERT_TRUE(drift && bounce);
  EXPECT_NEAR(drift->lag1_correlation.value(), 0, 0.02);
  EXPECT_NEAR(bounce->lag1_correlation.value(), 0.5, 0.03);
}

TEST(TemporalNoise, RefusesWhatHoldsNone) {
  const auto pictures = sequence(3, 0);
  const std::vector<TimedPicture> same{{pictures[0].picture, 0, 0}, {pictures[0].picture, 1, 0}};
  const std::vector<TimedPicture> apart{pictures[0], {pictures[1].picture, 1, 1}};

  EXPECT_FALSE(temporal_noise(same));
  EXPECT_FALSE(temporal_noise(apart));
  EXPECT_FALSE(temporal_noise({}));
}

TEST(FirstOrderCorrelation, IsTheRootOfItsSeries) {
  for (const int lag : {2, 3, 5, 8}) {
    for (const double rho : {-0.4, 0.0, 0.3, 0.95}) {
      double sum = 0;
      for (int j = 0; j < lag; ++j) sum += std::pow(rho, j);

      EXPECT_NEAR(first_order_correlation(sum, lag), rho, 1e-9) << lag << " " << rho;
    }
    EXPECT_EQ(first_order_correlation(lag + 1.0, lag), 1);
  }
}

}  // namespace
}  // namespace todbench
