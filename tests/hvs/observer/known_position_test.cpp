// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/observer/known_position.h"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "acquisition/base/rng.h"

namespace todbench {
namespace {

TEST(KnownPosition, EqualsTheOneDimensionalIntegralForOrthogonalTemplates) {
  // Four orthogonal templates of unit norm: P = integral of phi(x - d) Phi(x)^3 (Green and Swets 1966); d' 4AFC of 75 %
  // is 1.6828.
  for (const double d : {0.0, 0.5, 1.0, 1.6828, 3.0}) {
    KnownPositionTask task;
    task.mean = {d, 0, 0, 0};
    for (std::size_t i = 0; i < 4; ++i) task.gram[i][i] = 1;
    double integral = 0;
    const double h = 1e-3;
    for (double x = -10; x < 13; x += h) {
      const double phi = std::exp(-(x - d) * (x - d) / 2) / std::sqrt(2 * std::numbers::pi);
      integral += h * phi * std::pow(0.5 * std::erfc(-x / std::numbers::sqrt2), 3);
    }

    EXPECT_NEAR(probability_correct(task, 96), integral, 1e-6) << d;
  }
}

TEST(KnownPosition, IsChanceWithoutSignalAndCertainWithoutNoise) {
  KnownPositionTask task;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) task.gram[i][j] = i == j ? 1 : 0.9999;
  }

  EXPECT_NEAR(probability_correct(task, 64), 0.25, 1e-5);
  task.noise = 0;
  EXPECT_EQ(probability_correct(task, 64), 0.25);
  task.mean = {1, 0.5, 0.5, 0.99};
  EXPECT_EQ(probability_correct(task, 64), 1);
  task.mean = {1, 0.5, 0.5, 1.01};
  EXPECT_EQ(probability_correct(task, 64), 0);
}

TEST(KnownPosition, AgreesWithSimulationForCorrelatedTemplates) {
  KnownPositionTask task;
  task.mean = {1.231, 1.214, 1.207, 1.224};
  const double g[4] = {1, 0.9932, 0.9864, 0.9932};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) task.gram[i][j] = g[(j + 4 - i) % 4];
  }
  task.noise = 0.1;
  // Circulant Gram matrix: responses are sums of independent parts along its real Fourier vectors.
  const double l0 = g[0] + 2 * g[1] + g[2], l1 = g[0] - g[2], l2 = g[0] - 2 * g[1] + g[2];
  const RandomStream stream(1, "known position");
  const int n = 400'000;
  int correct = 0;
  for (int d = 0; d < n; ++d) {
    const auto z = [&](int k) { return static_cast<double>(stream.normal(static_cast<std::uint64_t>(4 * d + k))); };
    double r[4];
    for (int i = 0; i < 4; ++i) {
      const double angle = std::numbers::pi / 2 * i;
      r[i] = task.mean[static_cast<std::size_t>(i)] +
             task.noise *
                 (std::sqrt(l0) / 2 * z(0) + std::sqrt(l1 / 2) * (std::cos(angle) * z(1) + std::sin(angle) * z(2)) +
                  std::sqrt(std::max(l2, 0.0)) / 2 * std::cos(std::numbers::pi * i) * z(3));
    }
    correct += r[0] > r[1] && r[0] > r[2] && r[0] > r[3] ? 1 : 0;
  }

  const double p = probability_correct(task, 96);

  EXPECT_NEAR(p, static_cast<double>(correct) / n, 4 * std::sqrt(p * (1 - p) / n));
}

}  // namespace
}  // namespace todbench
