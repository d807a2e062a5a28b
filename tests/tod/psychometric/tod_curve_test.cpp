// SPDX-License-Identifier: GPL-3.0-or-later
// Trials in, TOD curve out.
#include "tod/psychometric/tod_curve.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/tod/psychometric/psychometric_support.h"

namespace todbench {
namespace {

using testing::geometric;

constexpr int presentations = 24, rows = 8, columns = 4;

// What a simulated bench would record: every presentation shows `rows` sizes `columns` times.
struct Bench {
  double threshold_mrad = 2;
  double presentation_sd = 0;  // of ln threshold, shared by a presentation
  double place_sd = 0;         // shared by a place on the plate
  double lapse = 0;
};

std::vector<Trial> trials_at(double contrast, const Bench& bench, std::uint64_t seed) {
  const RandomStream stream(seed, "bench");
  const std::vector<double> sizes = geometric(0.6 * bench.threshold_mrad, 2 * bench.threshold_mrad, rows);
  std::vector<Trial> trials;
  for (int p = 0; p < presentations; ++p) {
    for (int place = 0; place < rows * columns; ++place) {
      Trial trial;
      trial.presentation = 1000 * static_cast<std::int64_t>(contrast) + p;
      trial.plate = "plate";
      trial.triangle = "triangle " + std::to_string(place);
      trial.set_delta_t_k = contrast;
      trial.delta_t_k = contrast * 0.9 + 0.01 * (p % 2);
      trial.size_mrad = sizes[static_cast<std::size_t>(place / columns)];
      const double effect =
          bench.presentation_sd * static_cast<double>(stream.sub(1).normal(static_cast<std::uint64_t>(p))) +
          bench.place_sd * static_cast<double>(stream.sub(2).normal(static_cast<std::uint64_t>(place)));
      const double psi = psychometric(PsychometricForm::size, trial.size_mrad, bench.threshold_mrad * std::exp(effect),
                                      4, bench.lapse);
      trial.truth = Apex::left;
      const bool right = stream.sub(3).uniform(trials.size()) < psi;
      trial.answer = right ? Apex::left : Apex::up;
      trials.push_back(trial);
    }
  }
  return trials;
}

TEST(TodCurve, GroupsTrialsByContrastStrongestFirst) {
  std::vector<Trial> trials = trials_at(2, {2.0}, 1);
  for (const Trial& trial : trials_at(10, {1.5}, 2)) trials.push_back(trial);

  const auto curve = tod_curve(trials, {});

  ASSERT_TRUE(curve) << curve.error().message;
  ASSERT_EQ(curve->points.size(), 2u);
  EXPECT_EQ(curve->points[0].set_delta_t_k, 10);
  EXPECT_EQ(curve->points[1].set_delta_t_k, 2);
  const double limits[] = {1.5, 2.0};
  for (std::size_t i = 0; i < 2; ++i) {
    const TodPoint& point = curve->points[i];
    EXPECT_EQ(point.fit.verdict, FitVerdict::ok);
    EXPECT_EQ(point.fit.trials, presentations * rows * columns);
    // 768 trials: standard error about 2 % (statistics of constant stimuli, span 3.3), four of them.
    EXPECT_NEAR(point.fit.threshold.value(), limits[i], 0.08 * limits[i]);
    EXPECT_TRUE(point.fit.posterior.has_value());
    double counted = 0;
    for (const Level& level : point.levels) counted += level.total;
    EXPECT_EQ(counted, point.fit.trials);
  }
  EXPECT_TRUE(curve->observer.empty() && curve->sensor.empty());
}

TEST(TodCurve, ReportsTheMeanEffectiveContrastAndItsErrorOverMeasurements) {
  const auto curve = tod_curve(trials_at(2, {}, 3), {});

  ASSERT_TRUE(curve);
  EXPECT_NEAR(curve->points[0].delta_t_k, 1.805, 1e-12);
  // Two measurements, 1.80 and 1.81, however many presentations share them: sd 0.01 / sqrt(2), over sqrt(2).
  EXPECT_NEAR(curve->points[0].delta_t_se_k, 0.005, 1e-12);
}

TEST(TodCurve, ClustersByPresentationWhenPresentationsDiffer) {
  const auto curve = tod_curve(trials_at(2, {.presentation_sd = 0.25}, 4), {});

  ASSERT_TRUE(curve);
  EXPECT_EQ(curve->points[0].fit.clusters, presentations);
  EXPECT_GT(curve->points[0].fit.variance_inflation, 2);
}

TEST(TodCurve, ClustersByPlaceWhenPlacesDiffer) {
  const auto curve = tod_curve(trials_at(2, {.place_sd = 0.25}, 5), {});

  ASSERT_TRUE(curve);
  EXPECT_EQ(curve->points[0].fit.clusters, rows * columns);
  EXPECT_GT(curve->points[0].fit.variance_inflation, 2);
}

TEST(TodCurve, MountingsOfAPlateAreDifferentPlaces) {
  std::vector<Trial> trials = trials_at(2, {.place_sd = 0.25}, 5);
  for (Trial& trial : trials)
    if (trial.presentation % 2 == 0) trial.mounting = Mounting::rotated_180;

  const auto curve = tod_curve(trials, {});

  ASSERT_TRUE(curve);
  EXPECT_EQ(curve->points[0].fit.clusters, 2 * rows * columns);
}

TEST(TodCurve, ASinglePlaceLeavesClusteringToThePresentations) {
  std::vector<Trial> trials = trials_at(2, {}, 6);
  for (Trial& trial : trials) trial.triangle = "the only one";

  const auto curve = tod_curve(trials, {});

  ASSERT_TRUE(curve);
  EXPECT_EQ(curve->points[0].fit.clusters, presentations);
  EXPECT_TRUE(curve->points[0].fit.usable());
}

TEST(TodCurve, WarnsOfLapsesThatTheModelDoesNotAllow) {
  const auto careless = tod_curve(trials_at(2, {.lapse = 0.06}, 7), {});
  const auto careful = tod_curve(trials_at(2, {}, 8), {});
  const auto allowed = tod_curve(trials_at(2, {.lapse = 0.06}, 7), {.fixed_lapse = std::nullopt});

  ASSERT_TRUE(careless && careful && allowed);
  EXPECT_TRUE(careless->points[0].lapse_warning);
  EXPECT_GT(careless->points[0].free_lapse_fit.value().lapse, 0.02);
  EXPECT_FALSE(careful->points[0].lapse_warning);
  EXPECT_TRUE(careful->points[0].free_lapse_fit.has_value());
  EXPECT_FALSE(allowed->points[0].lapse_warning);
  EXPECT_FALSE(allowed->points[0].free_lapse_fit.has_value());
}

TEST(TodCurve, KeepsAContrastWithoutAThreshold) {
  std::vector<Trial> trials = trials_at(2, {}, 9);
  for (Trial trial : trials_at(1, {}, 10)) {
    trial.answer = trial.truth;
    trials.push_back(trial);
  }

  const auto curve = tod_curve(trials, {});

  ASSERT_TRUE(curve);
  ASSERT_EQ(curve->points.size(), 2u);
  EXPECT_EQ(curve->points[1].fit.verdict, FitVerdict::below_range);
  EXPECT_FALSE(curve->points[1].fit.threshold);
}

TEST(TodCurve, RefusesNoTrialsAndWrongSizes) {
  std::vector<Trial> trials = trials_at(2, {}, 11);
  trials[5].size_mrad = NAN;

  const auto none = tod_curve({}, {});
  const auto wrong = tod_curve(trials, {});

  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::invalid_input);
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, ErrorCode::invalid_input);
}

}  // namespace
}  // namespace todbench
