// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/psychometric/ramp_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "acquisition/base/distributions.h"
#include "tests/tod/psychometric/ramp_support.h"

namespace todbench {
namespace {

using test::answers_of;
using test::LogisticSensor;
using test::RampErrors;
using test::sc2000_noise;
using test::surface_of;

constexpr double between_k[] = {10, 4, 1.2, 0.5, 0.3};  ///< no contrast of a table, no contrast of a ramp

TEST(ContrastSurface, ItsBendIsZeroWhereTheObserverDecidesAndGrowsWithTheNoise) {
  EXPECT_NEAR(contrast_bend(sc2000_noise, 1e6), 0, 1e-12);
  // hypot(0.07 / 0.2041, 0.07) / 0.07 = 5
  EXPECT_NEAR(contrast_bend(sc2000_noise, 0.07 / (0.07 * std::sqrt(24.0))), 1, 1e-12);
  EXPECT_EQ(contrast_bend(sc2000_noise, -1.93), contrast_bend(sc2000_noise, 1.93));
}

TEST(ContrastSurface, BetweenItsTablesItIsTheClosedFormWithinAThousandth) {
  const LogisticSensor sensor;

  const ContrastSurface surface = surface_of(sensor, 20, 0.18);

  for (const double delta_t_k : between_k) {
    EXPECT_NEAR(surface.ln_threshold(delta_t_k), sensor.ln_s75(delta_t_k), 1e-3) << delta_t_k;
    for (const double x : {-0.4, -0.1, 0.0, 0.2, 0.5}) {
      const double ln_size = sensor.ln_s75(delta_t_k) + x;
      EXPECT_NEAR(surface.at(ln_size, delta_t_k).proportion, sensor.proportion(ln_size, delta_t_k), 2e-3)
          << delta_t_k << " " << x;
    }
    // d ln S75 / d ln dT = -(b / dT)^2 / S75^2
    const double slope = -std::pow(sensor.b / delta_t_k, 2) / std::exp(2 * sensor.ln_s75(delta_t_k));
    EXPECT_NEAR(surface.slope(delta_t_k), slope, 0.02) << delta_t_k;
  }
}

TEST(RampFit, ACameraLikeItsTwinHasTheCurveOfTheTwin) {
  const LogisticSensor sensor;

  const auto fit = RampFit::of(answers_of(sensor, {}, 1), surface_of(sensor, 20, 0.18));

  ASSERT_TRUE(fit) << fit.error().message;
  for (const double delta_t_k : between_k) {
    const RampValue value = fit->at(delta_t_k);
    EXPECT_NEAR(value.ln_s75, sensor.ln_s75(delta_t_k), 4 * std::sqrt(value.variance.variance) + 1e-3) << delta_t_k;
    EXPECT_LT(std::sqrt(value.variance.variance), 0.02) << delta_t_k;
  }
}

TEST(RampFit, ABlurredAndANoisyCameraAreFoundByTheStretch) {
  const LogisticSensor twin;

  for (const LogisticSensor& camera : {LogisticSensor{2.3, 0.6}, LogisticSensor{2, 0.75}, LogisticSensor{2.2, 0.5}}) {
    const auto fit = RampFit::of(answers_of(camera, {}, 2), surface_of(twin, 20, 0.18));

    ASSERT_TRUE(fit) << fit.error().message;
    for (const double delta_t_k : between_k) {
      const RampValue value = fit->at(delta_t_k);
      // A stretch that is quadratic in u describes such cameras within 0.6 %.
      EXPECT_NEAR(value.ln_s75, camera.ln_s75(delta_t_k), 4 * std::sqrt(value.variance.variance) + 6e-3)
          << camera.a << " " << camera.b << " " << delta_t_k;
    }
  }
}

TEST(RampFit, ADifferenceOfTheDirectionsIsFoundAndNoneIsNot) {
  const LogisticSensor sensor;
  const ContrastSurface surface = surface_of(sensor, 20, 0.18);
  const RampErrors lagging{.of_set_up = 0.01, .of_presentation = 0.01, .up_against_down = 0.03};
  const RampErrors even{.of_set_up = 0.01, .of_presentation = 0.01};

  const auto found = RampFit::of(answers_of(sensor, lagging, 3), surface)->up_against_down();
  const auto none = RampFit::of(answers_of(sensor, even, 3), surface)->up_against_down();

  ASSERT_TRUE(found && none);
  EXPECT_NEAR(found->ln_up_over_down, 0.03, 4 * found->standard_error);
  EXPECT_TRUE(found->beyond());
  EXPECT_FALSE(none->beyond());
}

TEST(RampFit, RampsOfOneDirectionHaveNoDifference) {
  const LogisticSensor sensor;
  auto answers = answers_of(sensor, {.of_set_up = 0.01}, 3);
  std::erase_if(answers, [](const RampAnswer& one) { return one.direction == RampDirection::up; });

  const auto fit = RampFit::of(std::move(answers), surface_of(sensor, 20, 0.18));

  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_FALSE(fit->up_against_down());
}

TEST(RampFit, IntervalsCoverTheTruthAtContrastsThatAreNotThoseOfTheAnswers) {
  const LogisticSensor sensor;
  const ContrastSurface surface = surface_of(sensor, 20, 0.18);
  const RampErrors errors{.of_set_up = 0.01, .of_presentation = 0.02, .contrast = 0.01};
  constexpr int runs = 60;
  int covered = 0;
  double mean = 0;

  for (int run = 0; run < runs; ++run) {
    const auto fit = RampFit::of(answers_of(sensor, errors, 100 + static_cast<std::uint64_t>(run)), surface);
    ASSERT_TRUE(fit) << fit.error().message;
    for (const double delta_t_k : between_k) {
      const RampValue value = fit->at(delta_t_k);
      const double half =
          distribution::quantile_above(0.025, value.variance.degrees_of_freedom) * std::sqrt(value.variance.variance);
      const double error = value.ln_s75 - sensor.ln_s75(delta_t_k);
      covered += std::abs(error) <= half ? 1 : 0;
      mean += error / (runs * std::size(between_k));
    }
  }

  // The five contrasts of a run share its error: 60 independent runs, standard deviation sqrt(0.95 x 0.05 / 60) = 2.8
  // %.
  EXPECT_NEAR(covered / (runs * 5.0), 0.95, 3 * 0.028);
  EXPECT_NEAR(mean, 0, 3 * 0.01 / std::sqrt(8.0 * runs) + 1e-3);
}

TEST(RampFit, FindsItsMaximumWhereTheSlopeOfTheSurfaceJumps) {
  // A simulated table has errors. Its end has the slope of two intervals, and the curve a different one.
  const LogisticSensor sensor;
  constexpr std::uint64_t runs = 200;

  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    auto answers = answers_of(sensor, {.of_set_up = 0.01, .of_presentation = 0.02}, seed);
    std::erase_if(answers, [](const RampAnswer& one) { return one.answer.presentation % 40 % 8 != 0; });
    const auto fit = RampFit::of(std::move(answers), surface_of(sensor, 20, 0.18, 0.005, seed));
    ASSERT_TRUE(fit) << seed << ": " << fit.error().message;
    const RampValue value = fit->at(1.2);
    EXPECT_NEAR(value.ln_s75, sensor.ln_s75(1.2), 5 * std::sqrt(value.variance.variance) + 0.02) << seed;
  }
}

TEST(RampFit, NoAnswersAreAnError) {
  const auto fit = RampFit::of({}, surface_of({}, 20, 0.18));

  ASSERT_FALSE(fit);
  EXPECT_EQ(fit.error().code, ErrorCode::invalid_input);
}

}  // namespace
}  // namespace todbench
