// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/direct_estimate.h"

#include <gmock/gmock.h>

#include <cmath>
#include <ctime>

#include "tests/sim_devices/prediction/direct_scatter.h"
#include "tests/sim_devices/reference.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

TEST(DirectEstimate, ReproducesTheReferenceThresholdsOfTheRecommendedObserver) {
  const SensorSpec spec = test::sc2000();
  TemplateObserver observer({}, triangle_alternatives());

  const auto points =
      direct_estimate(spec, full_plan(spec, {}, {}), observer, {16.9, 0.23}, {.accuracy = Accuracy::normal()});

  ASSERT_TRUE(points.has_value()) << points.error().message;
  const auto document = test::reference();
  const auto& rows = document.at("S75_recommended_observer").at("normal");
  for (std::size_t i = 0; i < 2; ++i) {
    const double expected = rows[i].at("S75_pitch");
    const double se = std::hypot(rows[i].at("se").get<double>(), (*points)[i].standard_error_pitch);
    EXPECT_NEAR((*points)[i].s75_pitch, expected, 0.01 * expected + 3 * se);
    EXPECT_LT((*points)[i].standard_error_pitch / expected, 0.01);
    RecordProperty("s75_pitch_" + std::to_string(i), std::to_string((*points)[i].s75_pitch));
    std::printf("dT %.2f K: S75 = %.4f +- %.4f pitch, reference %.4f\n", (*points)[i].delta_t_k, (*points)[i].s75_pitch,
                (*points)[i].standard_error_pitch, expected);
  }
}

TEST(DirectEstimate, ReproducesTheUniversalCurveForNormalAndMicroscanSampling) {
  SensorSpec spec = test::sc2000();
  TemplateObserverSpec silent;
  silent.internal_noise = 0;  // q_eff is then the sensor's noise over the contrast alone
  TemplateObserver observer(silent, triangle_alternatives());
  const SensorPlan plan = full_plan(spec, {Effect::quantisation}, {});
  const auto document = test::reference();
  for (const auto& row : document.at("S75_vs_q_eff").at("rows")) {
    const double q = row.at("q_eff");
    for (const auto& [name, samples] : {std::pair("normal", 1), std::pair("microscan", 2)}) {
      const auto points = direct_estimate(spec, plan, observer, {spec.netd_k / q},
                                          {.samples_per_pitch = samples, .accuracy = Accuracy::normal()});

      ASSERT_TRUE(points.has_value()) << points.error().message;
      const double expected = row.at(name).at("val");
      const double se = std::hypot(row.at(name).at("se").get<double>(), (*points)[0].standard_error_pitch);
      std::printf("q_eff %.2f %s: S75 = %.4f +- %.4f pitch, reference %.4f\n", q, name, (*points)[0].s75_pitch,
                  (*points)[0].standard_error_pitch, expected);
      EXPECT_NEAR((*points)[0].s75_pitch, expected, 0.015 * expected + 3 * se) << q << " " << name;
    }
  }
}

TEST(DirectEstimate, StandardErrorIsTheSpreadOverSeeds) {
  constexpr int runs = 50;

  for (const auto& s : testing::direct_scatter(test::sc2000(), {16.9, 0.23}, Accuracy::draft(), runs, 1)) {
    // sqrt of chi-square with 49 degrees of freedom over 49 lies in [0.71, 1.31] with probability 0.998.
    EXPECT_GT(s.ratio(), 0.71) << s.delta_t_k;
    EXPECT_LT(s.ratio(), 1.31) << s.delta_t_k;
  }
}

TEST(DirectEstimate, AddsDrawsUntilTheDemandedStandardErrorIsMet) {
  const SensorSpec spec = test::sc2000();
  for (const double tolerance : {1.0, 5.0}) {
    TemplateObserver observer({}, triangle_alternatives());
    DirectEstimateOptions options;
    options.accuracy = Accuracy::for_tolerance(tolerance);
    const std::clock_t begin = std::clock();

    const auto points = direct_estimate(spec, full_plan(spec, {}, {}), observer, {16.9, 1.93, 0.23}, options);

    ASSERT_TRUE(points.has_value()) << points.error().message;
    for (const auto& point : *points) EXPECT_LE(point.standard_error_pitch / point.s75_pitch, tolerance / 200);
    std::printf("tolerance %.0f %%: %.2f s of processor time, %d draws per size at 0.23 K\n", tolerance,
                static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, points->back().noise_draws);
  }
}

TEST(DirectEstimate, SaysWhatIsReachableWhenAToleranceIsNot) {
  const SensorSpec spec = test::sc2000();
  TemplateObserver observer({}, triangle_alternatives());
  DirectEstimateOptions options;
  options.accuracy = Accuracy::for_tolerance(0.05);

  const auto refused = direct_estimate(spec, full_plan(spec, {}, {}), observer, {0.23}, options);

  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(refused.error().message,
              ::testing::HasSubstr("a tolerance of 0.05 % cannot be met at a contrast of 0.23 K"));
  EXPECT_THAT(refused.error().message, ::testing::HasSubstr("The best reachable tolerance is"));
}

TEST(DirectEstimate, RefusesAContrastWithoutThreshold) {
  const SensorSpec spec = test::sc2000();
  TemplateObserver observer({}, triangle_alternatives());

  const auto hopeless =
      direct_estimate(spec, full_plan(spec, {}, {}), observer, {1e-4}, {.accuracy = Accuracy::draft()});
  const auto zero = direct_estimate(spec, full_plan(spec, {}, {}), observer, {0.0}, {.accuracy = Accuracy::draft()});

  ASSERT_FALSE(hopeless.has_value());
  EXPECT_EQ(hopeless.error().code, ErrorCode::invalid_input);
  ASSERT_FALSE(zero.has_value());
}

}  // namespace
}  // namespace todbench
