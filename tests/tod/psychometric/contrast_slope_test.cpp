// SPDX-License-Identifier: GPL-3.0-or-later
// What an error of a contrast does to the acuity, and what its scatter does to a ratio.
#include "tod/psychometric/contrast_slope.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "acquisition/base/distributions.h"
#include "acquisition/base/rng.h"
#include "tod/comparison/comparison.h"

namespace todbench {
namespace {

constexpr double z95 = 1.959964, z90 = 1.644854;

/// A threshold with a symmetric interval of ln S75, its standard error u of very many degrees of freedom.
TodPoint point_of(double delta_t_k, double s75_mrad, double u) {
  TodPoint point;
  point.set_delta_t_k = point.delta_t_k = delta_t_k;
  point.fit.verdict = FitVerdict::ok;
  point.fit.threshold = s75_mrad;
  point.fit.ci95 = {s75_mrad * std::exp(-z95 * u), s75_mrad * std::exp(z95 * u)};
  point.fit.ci90 = {s75_mrad * std::exp(-z90 * u), s75_mrad * std::exp(z90 * u)};
  point.fit.se_ln_threshold = u;
  point.fit.twin_shape.emplace();
  return point;
}

/// d ln acuity / d ln contrast of S^2 = a + b / C + d / C^2.
double slope_of(double a, double b, double d, double contrast_k) {
  const double z = 1 / contrast_k;
  return z * (b + 2 * d * z) / (2 * (a + b * z + d * z * z));
}

TEST(ContrastSlope, IsThatOfTheCurve) {
  constexpr double a = 4.2, b = 0.4, d = 0.3;
  TodCurve power, resolved;
  for (const double contrast_k : {10.0, 2.0, 0.5, 0.2}) {
    power.points.push_back(point_of(contrast_k, 2 * std::pow(contrast_k, -0.5), 0.01));
    resolved.points.push_back(
        point_of(contrast_k, std::sqrt(a + b / contrast_k + d / (contrast_k * contrast_k)), 0.01));
  }

  EXPECT_THAT(contrast_slopes(power), ::testing::Each(::testing::DoubleNear(0.5, 1e-12)));
  const auto slopes = contrast_slopes(resolved);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(slopes[i], slope_of(a, b, d, resolved.points[i].set_delta_t_k), 1e-12) << i;
}

TEST(ContrastSlope, LeavesOutAThresholdThatTheAnswersDoNotDetermine) {
  TodCurve curve;
  for (const double contrast_k : {10.0, 2.0, 0.5})
    curve.points.push_back(point_of(contrast_k, 2 + 1 / contrast_k, 0.01));
  const auto without = contrast_slopes(curve);
  TodPoint far = point_of(0.2, 7e8, 0.01);
  far.fit.verdict = FitVerdict::extrapolated;
  far.fit.ci95.high.reset();
  curve.points.push_back(far);

  auto with = contrast_slopes(curve);

  with.pop_back();
  EXPECT_EQ(with, without);
}

TEST(ContrastSlope, OfTwoPointsIsNotTooSmall) {
  for (const double d : {0.0, 0.1, 0.3}) {
    const double b = 0.4, a = 4.2;
    TodCurve curve;
    for (const double contrast_k : {2.0, 0.23})
      curve.points.push_back(point_of(contrast_k, std::sqrt(a + b / contrast_k + d / (contrast_k * contrast_k)), 0.01));
    EXPECT_GE(contrast_slopes(curve)[1], slope_of(a, b, d, 0.23) - 1e-12) << d;
  }
}

/// Direct estimates of the SC2000 with hvs-1 (standard error 0.1 %), whose slopes between contrasts 10 % to each side
/// are 0.51 at 0.23 K and 0.04 at 1.93 K. A parabola over ln contrast has 0.33 and 0.12.
TEST(ContrastSlope, OfASimulatedSensorIsItsOwn) {
  TodCurve curve;
  curve.points = {point_of(16.9, 2.0899, 0.01), point_of(1.93, 2.1373, 0.01), point_of(0.23, 3.4384, 0.01)};
  const auto slopes = contrast_slopes(curve);
  EXPECT_LT(slopes[0], 0.01);
  EXPECT_NEAR(slopes[1], 0.04, 0.01);
  EXPECT_GT(slopes[2], 0.48);
  EXPECT_LT(slopes[2], 0.62);
}

TEST(ContrastSlope, IsOneWhereNothingTells) {
  TodCurve curve;
  curve.points = {point_of(2, 1, 0.01), point_of(-2, 1, 0.01), point_of(0.2, 1, 0.01)};
  curve.points[2].fit.threshold.reset();

  EXPECT_THAT(contrast_slopes(curve), ::testing::ElementsAre(1, 1, 1));
}

/// S75 of a simulated SC2000 with hvs-1, nearly: 2.09, 2.14 and 3.44 mrad.
double s75_at(double contrast_k) {
  return std::sqrt(4.3 + 0.31 / contrast_k + 0.32 / (contrast_k * contrast_k));
}

struct DrawnRatio {
  bool holds_one = false;
  double half_width = 0;  ///< of 95 %, in ln
};

/// Two equal cameras of which the second is shown what the first measured of the contrast, in eight set-ups with a
/// scatter of 2.5 %, as in the demonstration. The answers of the first are scored with the measured contrast, too.
DrawnRatio ratio_of_equals(std::uint64_t seed, bool with_contrast) {
  constexpr double u = 0.004, scatter = 0.025;
  constexpr int set_ups = 8;
  const RandomStream stream(seed, "contrast");
  std::vector<double> measured;
  for (std::uint64_t i = 0; i < set_ups; ++i) measured.push_back(0.23 * (1 + scatter * stream.normal(i)));
  const double mean = std::accumulate(measured.begin(), measured.end(), 0.0) / set_ups;
  double squares = 0;
  for (const double contrast : measured) squares += (contrast - mean) * (contrast - mean);

  TodCurve camera, twin;
  camera.observer = twin.observer = "hvs-1";
  for (const double contrast : {16.9, 1.93}) {
    camera.points.push_back(point_of(contrast, s75_at(contrast), u));
    twin.points.push_back(camera.points.back());
  }
  const double by_score = measured_contrast_slope - slope_of(4.3, 0.31, 0.32, 0.23);
  const double scored = std::pow(mean / 0.23, by_score);
  camera.points.push_back(point_of(0.23, s75_at(0.23) * scored * std::exp(u * stream.normal(100)), u));
  camera.points.back().delta_t_k = mean;
  camera.points.back().delta_t_se_k = std::sqrt(squares / (set_ups - 1) / set_ups);
  camera.points.back().delta_t_measurements = set_ups;
  twin.points.push_back(point_of(0.23, s75_at(mean) * std::exp(u * stream.normal(101)), u));
  twin.points.back().delta_t_k = mean;

  ComparisonOptions options;
  options.b_shown_contrasts_of_a = with_contrast;
  const auto found = compare(camera, twin, options);
  EXPECT_TRUE(found) << found.error().message;
  const ComparisonPoint& point = found->points.back();
  const Interval& ci = point.ratio_ci95;
  const bool holds = *ci.low <= 1 && 1 <= *ci.high;
  // The test and the interval say the same where both are symmetric, up to the degrees of freedom: those of the sum
  // in the one, of each term in the other.
  const double p = *point.p_difference;
  EXPECT_FALSE(holds ? p < 0.03 : p > 0.08) << seed << " " << p;
  return {holds, 0.5 * std::log(*ci.high / *ci.low)};
}

TEST(ContrastScatter, IsInARatioToATwinThatWasShownIt) {
  constexpr int seeds = 2000;
  int with = 0, without = 0;
  double width_with = 0, width_without = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const DrawnRatio all = ratio_of_equals(static_cast<std::uint64_t>(seed), true);
    const DrawnRatio less = ratio_of_equals(static_cast<std::uint64_t>(seed), false);
    with += all.holds_one ? 1 : 0;
    without += less.holds_one ? 1 : 0;
    width_with += all.half_width / seeds;
    width_without += less.half_width / seeds;
  }
  const double one_se = std::sqrt(0.95 * 0.05 / seeds);
  // The two t of 7 degrees of freedom and of very many, joined as squares, hold a little more than 95 %.
  EXPECT_GT(static_cast<double>(with) / seeds, 0.95 - 3 * one_se);
  EXPECT_LT(static_cast<double>(with) / seeds, 0.97 + 3 * one_se);
  EXPECT_LT(static_cast<double>(without) / seeds, 0.95 - 3 * one_se);
  EXPECT_GT(width_with, 1.2 * width_without);
}

TEST(ContrastScatter, OfAContrastThatWasMeasuredOnceIsNotKnown) {
  TodCurve curve;
  curve.points.push_back(point_of(0.23, s75_at(0.23), 0.01));
  curve.points[0].delta_t_measurements = 1;
  EXPECT_EQ(contrast_se_k(curve.points[0]), std::nullopt);
  EXPECT_TRUE(has_contrast_measured_once(curve));

  curve.points[0].delta_t_measurements = 2;
  EXPECT_EQ(contrast_se_k(curve.points[0]), 0.0);
  EXPECT_FALSE(has_contrast_measured_once(curve));

  // A curve of counts in a file has no measurement of a contrast at all.
  curve.points[0].delta_t_measurements = 0;
  EXPECT_EQ(contrast_se_k(curve.points[0]), std::nullopt);
  EXPECT_FALSE(has_contrast_measured_once(curve));
}

TEST(ContrastScatter, IsTheSlopeTimesTheRelativeError) {
  TodCurve curve;
  for (const double contrast_k : {16.9, 1.93, 0.23})
    curve.points.push_back(point_of(contrast_k, s75_at(contrast_k), 0.01));
  curve.points[2].delta_t_se_k = 0.0023;
  curve.points[2].delta_t_measurements = 8;

  const auto scatter = contrast_scatter(curve);

  EXPECT_EQ(scatter[0].se_ln_acuity, 0);
  EXPECT_EQ(scatter[0].degrees_of_freedom, std::nullopt);
  // The slope of this curve is 0.57.
  EXPECT_NEAR(scatter[2].se_ln_acuity, 0.01 * measured_contrast_slope, 1e-9);
  EXPECT_EQ(scatter[2].degrees_of_freedom, 7);
}

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
