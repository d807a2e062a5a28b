// SPDX-License-Identifier: GPL-3.0-or-later
// What is joined to the interval of a camera's threshold.
#include "bench/twin/camera_surrogate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "acquisition/base/distributions.h"

namespace todbench {
namespace {

PsychometricFit fit_of(double threshold, double half_width) {
  PsychometricFit fit;
  fit.verdict = FitVerdict::ok;
  fit.threshold = threshold;
  fit.ci95 = {threshold * std::exp(-half_width), threshold * std::exp(half_width)};
  fit.ci90 = {threshold * std::exp(-0.8 * half_width), threshold * std::exp(0.8 * half_width)};
  return fit;
}

TEST(JoinedUncertainty, IsAddedInQuadratureOnBothSides) {
  PsychometricFit fit = fit_of(2, 0.01);

  join_uncertainty(fit, 0.005, 7.0);

  const double half = std::hypot(0.01, 0.005 * distribution::quantile_above(0.025, 7.0));
  EXPECT_NEAR(std::log(*fit.ci95.high / 2), half, 1e-12);
  EXPECT_NEAR(std::log(*fit.ci95.low / 2), -half, 1e-12);
  EXPECT_EQ(fit.joined_u, 0.005);
  EXPECT_EQ(fit.variance_inflation, 1) << "that of the answers";
}

TEST(JoinedUncertainty, LeavesAnOpenSideOpen) {
  PsychometricFit fit = fit_of(2, 0.01);
  fit.ci95.high.reset();

  join_uncertainty(fit, 0.005, std::nullopt);

  EXPECT_FALSE(fit.ci95.high);
  EXPECT_LT(*fit.ci95.low, 2 * std::exp(-0.01));
}

TEST(JoinedUncertainty, OfTheSeenContrastIsNothingWhereNobodyKnowsHowItScatters) {
  TodCurve curve;
  curve.points.resize(2);
  for (TodPoint& point : curve.points) point.fit = fit_of(2, 0.01);
  curve.points[0].set_delta_t_k = curve.points[0].delta_t_k = 1;
  curve.points[0].delta_t_se_k = 0.01;
  curve.points[0].delta_t_measurements = 8;
  curve.points[1].set_delta_t_k = curve.points[1].delta_t_k = 0.2;
  curve.points[1].delta_t_measurements = 1;

  join_contrast_errors(curve);

  // Two thresholds that are the same have no slope.
  EXPECT_NEAR(curve.points[0].fit.joined_u, 1.14 * 0.01, 1e-12);
  EXPECT_EQ(curve.points[1].fit.joined_u, 0);
}

}  // namespace
}  // namespace todbench
