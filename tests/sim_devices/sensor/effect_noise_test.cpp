// SPDX-License-Identifier: GPL-3.0-or-later
// Noise of the simulated sensor: what it remembers, what averaging leaves, dead detectors.
#include "sim_devices/sensor/effect_dead_pixels.h"

#include <gmock/gmock.h>

#include <cmath>

#include "sim_devices/sensor/sensor_model.h"
#include "tests/sim_devices/prediction/effect_grid.h"
#include "tests/sim_devices/sensor/effect_scene.h"

namespace todbench {
namespace {

using test::scene;

/// Sums over the pixels of two pictures.
struct Moments {
  double variance = 0, correlation = 0;
};

Moments moments(const cv::Mat1f& a, const cv::Mat1f& b) {
  const double n = static_cast<double>(a.total());
  const double aa = a.dot(a) / n, bb = b.dot(b) / n;
  return {aa, a.dot(b) / n / std::sqrt(aa * bb)};
}

SensorSpec remembering(double rho, int averaged = 1) {
  SensorSpec spec = test::sc2000();
  spec.noise_correlation = rho;
  spec.frames_averaged = averaged;
  return spec;
}

cv::Mat1f noise_of(const SensorSpec& spec, std::uint64_t index) {
  PlateScene still = scene(0);
  still.motion = {};
  return SensorModel(spec, full_plan(spec, {Effect::quantisation}, {}), Accuracy::draft(), 1).picture(still, index);
}

TEST(Effects, NoiseThatRemembersKeepsItsVarianceAndCorrelatesAsFirstOrder) {
  // 76800 pixels: a variance to 0.5 %, a correlation to 0.4 %; four times that.
  for (const double rho : {0.5, 0.8, 0.95}) {
    const SensorSpec spec = remembering(rho);
    const cv::Mat1f first = noise_of(spec, 1000);
    for (const int lag : {1, 2, 8}) {
      const Moments m = moments(first, noise_of(spec, 1000 + static_cast<std::uint64_t>(lag)));

      EXPECT_NEAR(m.variance / std::pow(spec.netd_k, 2), 1, 0.02) << rho;
      EXPECT_NEAR(m.correlation, std::pow(rho, lag), 0.015) << rho << " at lag " << lag;
    }
  }
}

TEST(Effects, AveragingNoiseThatRemembersLeavesTheVarianceThatTheEstimateCountsWith) {
  const SensorSpec spec = remembering(0.8, 4);
  const SensorPlan plan = full_plan(spec, {Effect::quantisation}, {});

  const double variance = moments(noise_of(spec, 3), noise_of(spec, 3)).variance;

  // Of four exposures: (4 + 2 (3 x 0.8 + 2 x 0.64 + 0.512)) / 16.
  EXPECT_NEAR(white_variance_k2(spec, plan, 1) / std::pow(spec.netd_k, 2), (4 + 2 * (2.4 + 1.28 + 0.512)) / 16, 1e-12);
  EXPECT_NEAR(variance / white_variance_k2(spec, plan, 1), 1, 0.02);
}

TEST(Effects, AveragingDividesTemporalAndLineNoiseByTheRootOfTheFrames) {
  SensorSpec spec = test::sc2000();
  spec.row_noise_k = 0.05;
  spec.frames_averaged = 4;
  PlateScene still = scene(0);
  still.motion = {};
  const SensorModel model(spec, full_plan(spec, {Effect::quantisation}, {}), Accuracy::draft(), 1);

  const cv::Mat1f out = model.picture(still, 0);

  cv::Mat1f rows;
  cv::reduce(out, rows, 1, cv::REDUCE_AVG);
  cv::Scalar mean, sd_all, sd_rows;
  cv::meanStdDev(out, mean, sd_all);
  cv::meanStdDev(rows, mean, sd_rows);
  // 240 rows: sd known to 1 / sqrt(480) = 4.6 %; 76 800 samples beside the rows' part.
  EXPECT_NEAR(sd_rows[0], 0.025, 4 * 0.046 * 0.025);
  EXPECT_NEAR(sd_all[0] * sd_all[0] - sd_rows[0] * sd_rows[0], 0.035 * 0.035, 4 * 0.0051 * 0.035 * 0.035);
}

TEST(Effects, DeadDetectorsShowTheMeanOfTheirLiveNeighbours) {
  cv::Mat1f values(3, 3);
  for (int i = 0; i < 9; ++i) values(i / 3, i % 3) = static_cast<float>(i * i);
  cv::Mat1b dead = cv::Mat1b::zeros(3, 3);
  dead(1, 1) = dead(0, 1) = 1;

  replace_dead(values, dead, 1);

  EXPECT_EQ(values(1, 1), (9.0F + 25.0F + 49.0F) / 3);  // left, right, below: above is dead
  EXPECT_EQ(values(0, 1), (0.0F + 4.0F) / 2);
}

TEST(Effects, TheShareOfDeadDetectorsIsTheStatedOne) {
  const cv::Mat1b dead = dead_detectors({320, 240}, 0.01, RandomStream(3, "dead"));
  // 768 expected, binomial sd 27.6.
  EXPECT_NEAR(cv::countNonZero(dead), 768, 4 * 27.6);
}

}  // namespace
}  // namespace todbench
