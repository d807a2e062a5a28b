// SPDX-License-Identifier: GPL-3.0-or-later
// Identification range against closed forms.
#include "tod/range/range_prediction.h"
#include "tod/psychometric/acuity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace todbench {
namespace {

TodThreshold threshold(double delta_t_k, double s75_mrad, double relative_half_width = 0) {
  if (relative_half_width == 0) return {delta_t_k, s75_mrad, {s75_mrad, s75_mrad}};
  return {delta_t_k, s75_mrad, {s75_mrad * std::exp(-relative_half_width), s75_mrad * std::exp(relative_half_width)}};
}

TEST(RangePrediction, WithoutAirTheRangeIsSizeTimesAcuityOverM75) {
  const std::vector<TodThreshold> tod{threshold(20, 2), threshold(0.2, 4)};

  const auto found = predict_range(tod, {.size_m = 4.9, .delta_t_k = 20, .m75 = 5.1});

  // 4.9 m under 1/S75 = 0.5 / mrad: 4900 / 2 / 5.1 m. Bisection ends at neighbouring doubles.
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_NEAR(found->r75_m.value(), 4900 / 2.0 / 5.1, 1e-10);
  EXPECT_TRUE(found->reason.empty());
}

TEST(RangePrediction, AcuityIsAStraightLineInLogarithmsBetweenThresholds) {
  const std::vector<TodThreshold> tod{threshold(0.2, 4), threshold(20, 2)};

  // The geometric middle of the contrasts has the geometric middle of the acuities.
  EXPECT_NEAR(interpolated_acuity_per_mrad(tod, 2).value(), 1 / std::sqrt(8.0), 1e-15);
  const auto found = predict_range(tod, {.size_m = 3, .delta_t_k = -2, .m75 = 6});
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_NEAR(found->r75_m.value(), 3000 / std::sqrt(8.0) / 6, 1e-10);
}

TEST(RangePrediction, AcuityIsConstantAboveTheHighestContrastAndUnknownBelowTheLowest) {
  const std::vector<TodThreshold> tod{threshold(0.2, 4), threshold(20, 2)};

  EXPECT_DOUBLE_EQ(interpolated_acuity_per_mrad(tod, 1000).value(), 0.5);
  EXPECT_FALSE(interpolated_acuity_per_mrad(tod, 0.199).has_value());
  EXPECT_NEAR(interpolated_acuity_per_mrad(tod, 0.2).value(), 0.25, 1e-15);
}

TEST(RangePrediction, ExtinctionOnAPowerLawGivesTheLambertEquation) {
  // acuity = dT^g through both points, so R exp(g k R / 1000) = 1000 L a(dT0) / M75 =: r0; solved here by Newton in the
  // equivalent form w exp(w) = g k r0 / 1000, w = g k R / 1000.
  const double g = 0.3, extinction = 0.8;
  const std::vector<TodThreshold> tod{threshold(0.01, std::pow(0.01, -g)), threshold(10, std::pow(10, -g))};

  const auto found = predict_range(tod, {.size_m = 5, .delta_t_k = 4, .m75 = 3, .extinction_per_km = extinction});

  const double argument = g * extinction / 1000 * (5000 * std::pow(4, g) / 3);
  double w = 0.5;
  for (int i = 0; i < 100; ++i) w -= (w * std::exp(w) - argument) / (std::exp(w) * (1 + w));
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_NEAR(found->r75_m.value(), 1000 * w / (g * extinction), 1e-8);
}

TEST(RangePrediction, ATargetLineThatNeverMeetsTheCurveHasNoRangeButABoundAndAReason) {
  const std::vector<TodThreshold> tod{threshold(1, 1), threshold(10, 1)};

  // 100 m under acuity 1 would reach 100 km / 5 = 20 km, but 10 K fall to 1 K after ln 10 / 1 km = 2302.6 m.
  const auto found = predict_range(tod, {.size_m = 100, .delta_t_k = 10, .m75 = 5, .extinction_per_km = 1});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_FALSE(found->r75_m.has_value());
  EXPECT_NE(found->reason.find("does not cross the TOD curve"), std::string::npos) << found->reason;
  EXPECT_NEAR(found->r75_ci95_m.low.value(), 1000 * std::log(10.0), 1e-6);
  EXPECT_FALSE(found->r75_ci95_m.high.has_value());
  for (const auto& point : found->curve) {
    EXPECT_EQ(point.probability.has_value(), point.range_m <= 1000 * std::log(10.0)) << point.range_m;
  }
}

TEST(RangePrediction, ATargetFainterThanTheLowestContrastHasNoRange) {
  const std::vector<TodThreshold> tod{threshold(1, 1), threshold(10, 1)};

  const auto found = predict_range(tod, {.size_m = 2, .delta_t_k = 0.5});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_FALSE(found->r75_m.has_value());
  EXPECT_NE(found->reason.find("below the lowest contrast"), std::string::npos) << found->reason;
  ASSERT_FALSE(found->curve.empty());
  for (const auto& point : found->curve) EXPECT_FALSE(point.probability.has_value());
}

TEST(RangePrediction, ATargetOfASetContrastHasItsPointWhateverTheCameraSawOfIt) {
  TodCurve curve;
  curve.points.resize(2);
  // What the camera saw lies above and below what was set, by more and by less than two contrasts may differ.
  const double set[] = {16.9, 1.93}, seen[] = {16.2, 1.93161}, s75[] = {2, 4};
  for (std::size_t i = 0; i < 2; ++i) {
    curve.points[i].set_delta_t_k = set[i];
    curve.points[i].delta_t_k = seen[i];
    curve.points[i].fit.verdict = FitVerdict::ok;
    curve.points[i].fit.threshold = s75[i];
    curve.points[i].fit.ci95 = {s75[i], s75[i]};
  }
  const ThresholdSelection selection = thresholds_of(curve, 1);

  for (std::size_t i = 0; i < 2; ++i) {
    for (const double asked : {set[i], seen[i], -set[i], 0.9999 * seen[i]}) {
      const auto found = predict_range(selection.thresholds, {.size_m = 4, .delta_t_k = asked, .m75 = 5});

      ASSERT_TRUE(found && found->r75_m) << asked;
      EXPECT_NEAR(*found->r75_m, 4000 / s75[i] / 5, 1e-9) << asked;
      EXPECT_EQ(found->notes.empty(), i == 1 || std::abs(asked) != 16.9) << asked;
    }
  }
  EXPECT_FALSE(predict_range(selection.thresholds, {.size_m = 4, .delta_t_k = 1.9})->r75_m);
}

TEST(RangePrediction, TheIntervalOfASinglePointIsThatOfItsThreshold) {
  const auto found = predict_range(std::vector{threshold(10, 2, 0.05)}, {.size_m = 4, .delta_t_k = 10, .m75 = 5});

  ASSERT_TRUE(found) << found.error().message;
  const double r75 = 4000 / 2.0 / 5;
  EXPECT_NEAR(found->r75_m.value(), r75, 1e-10);
  EXPECT_NEAR(found->r75_ci95_m.low.value(), r75 * std::exp(-0.05), 1e-10);
  EXPECT_NEAR(found->r75_ci95_m.high.value(), r75 * std::exp(0.05), 1e-10);
}

TEST(RangePrediction, BetweenTwoPointsTheirErrorsAreJoinedAsIndependentOnes) {
  const std::vector<TodThreshold> tod{threshold(1, 2, 0.04), threshold(100, 2, 0.03)};

  // At the middle the weights are 1/2: half-width sqrt(0.02^2 + 0.015^2) = 0.025.
  const auto found = predict_range(tod, {.size_m = 4, .delta_t_k = 10, .m75 = 5});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_NEAR(found->r75_ci95_m.high.value(), 400 * std::exp(0.025), 1e-9);
  EXPECT_NEAR(found->r75_ci95_m.low.value(), 400 * std::exp(-0.025), 1e-9);
}

TEST(RangePrediction, StatesTheRangeOverTheOpenParametersOfTheObserver) {
  std::vector<TodThreshold> tod{threshold(0.2, 4), threshold(20, 2)};
  const RangeTask task{.size_m = 3, .delta_t_k = -2, .m75 = 6};
  EXPECT_FALSE(predict_range(tod, task).value().r75_spread_m) << "an observer without open parameters";
  EXPECT_TRUE(predict_range(tod, task).value().notes.empty());

  tod[0].s75_spread_mrad = {3, 8};
  const auto half = predict_range(tod, task).value();
  EXPECT_FALSE(half.r75_spread_m);
  ASSERT_EQ(half.notes.size(), 1u);
  EXPECT_NE(half.notes[0].find("the threshold at 20 K has no spread"), std::string::npos) << half.notes[0];

  tod[1].s75_spread_mrad = {1.5, 2.5};
  const auto found = predict_range(tod, task).value();
  // Between two points: the geometric middle of the thresholds at the same end.
  ASSERT_TRUE(found.r75_spread_m);
  EXPECT_NEAR(found.r75_spread_m->first, 3000 / std::sqrt(8 * 2.5) / 6, 1e-9);
  EXPECT_NEAR(found.r75_spread_m->second, 3000 / std::sqrt(3 * 1.5) / 6, 1e-9);
  EXPECT_EQ(found.r75_m, half.r75_m);

  // With an air in which the best eyes still resolve the target at the end of the curve, that end has no range.
  const auto far = predict_range(tod, {.size_m = 3, .delta_t_k = -2, .m75 = 6, .extinction_per_km = 16}).value();
  ASSERT_TRUE(far.r75_m);
  EXPECT_FALSE(far.r75_spread_m);
  ASSERT_EQ(far.notes.size(), 1u);
  EXPECT_NE(far.notes[0].find("at one end"), std::string::npos) << far.notes[0];
}

TEST(RangePrediction, AnOpenSideOfAThresholdLeavesThatSideOfTheRangeOpen) {
  TodThreshold open = threshold(10, 2, 0.05);
  open.s75_ci95_mrad.low.reset();  // S75 may be anything smaller: the range may be anything larger

  const auto found = predict_range(std::vector{open}, {.size_m = 4, .delta_t_k = 10, .m75 = 5});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_TRUE(found->r75_ci95_m.low.has_value());
  EXPECT_FALSE(found->r75_ci95_m.high.has_value());
}

TEST(RangePrediction, AcuityThatFallsWithContrastGivesTheNearestCrossing) {
  // Acuity 1 at 1 K and 0.1 at 10 K: a(dT) = 1 / dT, and M = (r / R) exp(kR) / dT0 falls to R = 1/k and rises again.
  const std::vector<TodThreshold> tod{threshold(1, 1), threshold(10, 10)};

  const auto found = predict_range(tod, {.size_m = 5, .delta_t_k = 10, .m75 = 2.5, .extinction_per_km = 1});

  // R exp(-R / 1000) = 200 m on the falling side: w exp(-w) = 0.2.
  double w = 0.2;
  for (int i = 0; i < 200; ++i) w = 0.2 * std::exp(w);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_NEAR(found->r75_m.value(), 1000 * w, 1e-8);
}

TEST(RangePrediction, TheProbabilityIsThreeQuartersAtM75AndFallsWithRange) {
  const auto found = predict_range(std::vector{threshold(10, 2)}, {.size_m = 4.59, .delta_t_k = 10});

  // R75 = 450 m; at 400 m x = 1.76503 * 450 / 400 = 1.98566, E = 1.51 + 0.24 x = 1.98656, x^E = 3.9067.
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_NEAR(identification_probability(1), 0.75, 1e-12);
  EXPECT_NEAR(identification_probability(450.0 / 400), 3.9067 / 4.9067, 1e-5);
  EXPECT_NEAR(found->r75_m.value(), 450, 1e-9);
  for (std::size_t i = 1; i < found->curve.size(); ++i)
    EXPECT_LE(found->curve[i].probability.value(), found->curve[i - 1].probability.value());  // 1 close by
}

TEST(RangePrediction, V50OfSmallCraftIsTheM75ThatIsPublishedForThem) {
  EXPECT_NEAR(m75_from_v50(8.5), 5.1, 1e-14);
}

TEST(RangePrediction, RefusesWhatHasNoMeaning) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<TodThreshold> tod{threshold(10, 2)};

  for (const RangeTask& task :
       {RangeTask{.size_m = 0, .delta_t_k = 1}, RangeTask{.size_m = 1, .delta_t_k = 0},
        RangeTask{.size_m = nan, .delta_t_k = 1}, RangeTask{.size_m = 1, .delta_t_k = 1, .m75 = 0},
        RangeTask{.size_m = 1, .delta_t_k = 1, .m75 = 1, .extinction_per_km = -1}}) {
    EXPECT_FALSE(predict_range(tod, task).has_value());
  }
  EXPECT_FALSE(predict_range({}, {.size_m = 1, .delta_t_k = 1}).has_value());
  EXPECT_FALSE(predict_range(std::vector{threshold(1, 2), threshold(1, 3)}, {.size_m = 1, .delta_t_k = 1}).has_value());
}

TEST(RangePrediction, TakesThresholdsOfTheTargetsPolarityAndLeavesOutThoseWithoutValue) {
  TodCurve curve;
  TodPoint point;
  point.delta_t_k = 10;
  point.fit.threshold = 2;
  point.fit.verdict = FitVerdict::ok;
  curve.points.push_back(point);
  point.delta_t_k = -5;
  curve.points.push_back(point);
  point.delta_t_k = -1;
  point.fit.threshold.reset();
  curve.points.push_back(point);
  point.delta_t_k = -0.5;
  point.fit.threshold = 7e8;  // the answers are near chance at every size
  point.fit.verdict = FitVerdict::extrapolated;
  point.fit.ci95 = {4, {}};
  curve.points.push_back(point);

  const auto warm = thresholds_of(curve, 3);
  const auto cold = thresholds_of(curve, -3);

  ASSERT_EQ(warm.thresholds.size(), 1u);
  EXPECT_EQ(warm.thresholds[0].delta_t_k, 10);
  ASSERT_EQ(cold.thresholds.size(), 1u);
  EXPECT_EQ(cold.thresholds[0].delta_t_k, 5);
  EXPECT_EQ(cold.notes.size(), 2u);
}

TEST(RangePrediction, CarriesTheFindingsOfTheThresholdsThatItRestsOn) {
  std::vector<TodThreshold> tod{threshold(0.1, 4), threshold(1, 2), threshold(10, 1)};
  for (std::size_t i = 0; i < tod.size(); ++i) {
    const double ln_s75 = std::log(tod[i].s75_mrad);
    tod[i].s75_ci95_mrad = {std::exp(ln_s75 - 0.02), std::exp(ln_s75 + 0.02)};
    tod[i].adequacy.emplace();
    tod[i].adequacy->findings.push_back({.kind = FindingKind::lapse, .value = double(i), .unfit = i == 0});
  }
  const auto found = [&](double delta_t_k, double extinction_per_km) {
    const auto prediction =
        predict_range(tod, {.size_m = 2, .delta_t_k = delta_t_k, .extinction_per_km = extinction_per_km});
    std::vector<double> points;
    for (const auto& finding : prediction.value().adequacy.value().findings) points.push_back(finding.value.value());
    return std::pair(points, prediction->adequacy->adequate());
  };

  // Without extinction the contrast of the target is the only one; a point itself has no neighbours.
  EXPECT_EQ(found(20, 0), std::pair(std::vector{2.0}, true));
  EXPECT_EQ(found(3, 0), std::pair(std::vector({1.0, 2.0}), true));
  EXPECT_EQ(found(0.5, 0), std::pair(std::vector({0.0, 1.0}), false));
  // At about 236 m, where 1.9 of 20 K are left.
  EXPECT_EQ(found(20, 10), std::pair(std::vector({1.0, 2.0}), true));
  for (auto& point : tod) point.adequacy.reset();
  EXPECT_FALSE(predict_range(tod, {.size_m = 2, .delta_t_k = 20}).value().adequacy.has_value());
}

}  // namespace
}  // namespace todbench
