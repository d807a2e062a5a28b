// SPDX-License-Identifier: GPL-3.0-or-later
// The simulated sensor at the ends of its counts, without noise and drowned in it, and on two threads.
#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "sim_devices/prediction/direct_estimate.h"
#include "sim_devices/prediction/effect_planner.h"
#include "sim_devices/sensor/far_field.h"
#include "sim_devices/sensor/image_chain.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

PlateScene scene_of_one(double delta_t_k, double background_k = 300) {
  PlateScene scene;
  scene.plate.name = "one";
  scene.plate.triangles = {{.name = "only", .position_mm = {10, -20}, .size_mm = 40, .apex = Apex::right}};
  scene.delta_t_k = delta_t_k;
  scene.background_k = background_k;
  return scene;
}

SensorModel model(const SensorSpec& spec, const std::vector<Effect>& skip = {}) {
  return {spec, full_plan(spec, skip, {}), Accuracy::normal(), 1};
}

// Hard: a count is unsigned: what lies outside 0 ... 2^14 - 1 must stop at the end, not come round at the other. The
// range of the default sensor is 250 K ... 413.83 K.
TEST(SensorExtremes, FourteenBitCountsClipAtBothEndsAndNeverWrap) {
  const SensorSpec spec;
  const SensorModel sensor = model(spec);
  for (const double contrast : {200.0, 1e4, 1e9}) {
    const cv::Mat1w frame = sensor.expose(scene_of_one(contrast), 0);
    double low = 0, high = 0;
    cv::minMaxLoc(frame, &low, &high);
    EXPECT_EQ(high, 16383) << contrast;
    EXPECT_GT(low, 4000) << contrast;  // the surround, 5000 counts
  }
  for (const double contrast : {-200.0, -1e4, -1e9}) {
    const cv::Mat1w frame = sensor.expose(scene_of_one(contrast), 0);
    double low = 0, high = 0;
    cv::minMaxLoc(frame, &low, &high);
    EXPECT_EQ(low, 0) << contrast;
    EXPECT_LT(high, 6000) << contrast;
  }
  for (const auto& [background, count] : {std::pair(1e6, 16383), std::pair(0.0, 0)}) {
    const cv::Mat1w frame = sensor.expose(scene_of_one(1, background), 0);
    EXPECT_EQ(cv::countNonZero(frame != count), 0) << background;
  }
}

// Hard: values next to the last count. 16383 is 413.83 K exactly; half a count more still rounds to it.
TEST(SensorExtremes, TheLastCountIsReachedByRoundingAndHeld) {
  SensorSpec spec;
  spec.netd_k = 0;
  const SensorModel sensor = model(spec);
  for (const auto& [background, count] :
       {std::pair(413.824, 16382), std::pair(413.826, 16383), std::pair(413.834, 16383), std::pair(413.9, 16383),
        std::pair(250.004, 0), std::pair(250.006, 1)}) {
    const cv::Mat1w frame = sensor.expose(scene_of_one(0, background), 0);
    EXPECT_EQ(cv::countNonZero(frame != count), 0) << background;
  }
}

// Hard: a picture of 1 mK in single precision; it is kept above the surround, so that 300 K never enters it: float
// resolution of 1 mK is 6e-11 K.
TEST(SensorExtremes, APictureOfOneMillikelvinIsTheUnitPictureScaled) {
  SensorSpec spec;
  spec.netd_k = 0;
  const SensorModel sensor = model(spec, {Effect::quantisation});
  const auto unit = sensor.unit_signal(scene_of_one(1));

  const cv::Mat1f picture = sensor.picture(scene_of_one(1e-3), 0);

  double largest = 0;
  for (int j = 0; j < picture.rows; ++j) {
    for (int i = 0; i < picture.cols; ++i)
      largest =
          std::max(largest, std::abs(static_cast<double>(picture(j, i)) - 1e-3 * static_cast<double>((*unit)(j, i))));
  }
  EXPECT_LE(largest, 1.2e-10);
}

TEST(SensorExtremes, NoiseAThousandTimesTheSignalStaysFiniteAndHasItsSpread) {
  SensorSpec spec;
  spec.netd_k = 5;
  const SensorModel sensor = model(spec, {Effect::quantisation});

  const cv::Mat1f picture = sensor.picture(scene_of_one(0.005), 0);

  cv::Scalar mean, sd;
  cv::meanStdDev(picture, mean, sd);
  const double n = static_cast<double>(picture.total());
  EXPECT_NEAR(sd[0], 5, 4 * 5 / std::sqrt(2 * n));
  EXPECT_NEAR(mean[0], 0, 4 * 5 / std::sqrt(n) + 0.005);
}

// Hard: the integrand falls over decades and the region is what is left of a shape. A square of half side L round the
// point, without the one of half side R: 8 times the integral of cos / R - cos / L over an eighth of a turn.
TEST(SensorExtremes, FarIntegralsOfSquaresAreClosed) {
  for (const double outer : {40.0, 1e3, 1e9}) {
    const Polygon square{{-outer, -outer}, {outer, -outer}, {outer, outer}, {-outer, outer}};
    const double exact = 4 * std::sqrt(2.0) * (1 / 36.0 - 1 / outer);

    EXPECT_NEAR(far_integral(square, {0, 0}, 36), exact, 1e-5 * exact) << outer;
    // Corners lie where edges of that length meet the wall: rounding of 1e-16 of it on each of four sides of 72.
    EXPECT_NEAR(area(clipped(square, 36)), 72.0 * 72.0, 4 * 72 * 2.3e-16 * outer + 1e-9);
  }
  EXPECT_EQ(far_integral({{-5, -5}, {5, -5}, {5, 5}}, {1, 2}, 36), 0);
  EXPECT_TRUE(clipped({{50, 50}, {60, 50}, {60, 60}}, 36).empty());
}

// Hard: a lattice that holds a shape of 500 pitches has 10^9 frequencies. Only what is near a window is computed on
// one, the rest is the integrated tail: against the whole lattice where that can be had, at 70 pitches.
TEST(SensorExtremes, PicturesOfHugeTrianglesAreThoseOfTheWholeLattice) {
  const SensorSpec spec;
  const Accuracy accuracy = Accuracy::normal();
  const ImageChain chain(spec, full_plan(spec, {}, {}), accuracy);
  for (const cv::Point2d centre : {cv::Point2d(0.3, 0.2), cv::Point2d(2, 30.7)}) {  // inside, and across the base
    const Polygon shape = triangle(70, Apex::up, centre);

    const auto found = chain.infinite_plane(shape, {-2, -2}, 1, {5, 5});

    const cv::Mat1d whole = chain.image(shape).sample({-2, -2}, 1, {5, 5});
    EXPECT_LE(cv::norm(found.values, whole, cv::NORM_INF), accuracy.wrap_tolerance + found.max_error_estimate);
    EXPECT_LT(found.max_error_estimate, 1e-5);
  }
  double before = 0;
  for (const double size : {500.0, 1e9}) {
    const double middle = chain.infinite_plane(triangle(size, Apex::left), {0, 0}, 1, {1, 1}).values(0, 0);
    EXPECT_GT(middle, before) << size;  // the more of the spot's tail lies inside
    EXPECT_LE(middle, 1 + 1e-5) << size;
    before = middle;
  }
  EXPECT_NEAR(before, 1, 1e-5);  // a plane
}

TemplateObserver observer_with(double internal_noise) {
  TemplateObserverSpec spec;
  spec.internal_noise = internal_noise;
  return {spec, triangle_alternatives()};
}

// Hard: without any noise every answer is certain and proportions are steps; with noise a thousand times the contrast
// no size below 40 pitches is seen. Either is a number or a refusal in words.
TEST(SensorExtremes, DirectEstimatesWithoutNoiseAndDrownedInItAreNumbersOrRefusals) {
  SensorSpec spec;
  spec.netd_k = 0;
  TemplateObserver silent = observer_with(0);
  const SensorPlan plan = full_plan(spec, {Effect::quantisation}, {});
  Accuracy accuracy = Accuracy::draft();
  const auto certain = direct_estimate(spec, plan, silent, {1.0}, {.accuracy = accuracy});
  if (certain) {
    EXPECT_TRUE(std::isfinite((*certain)[0].s75_pitch) && (*certain)[0].s75_pitch > 0.2);
    EXPECT_TRUE(std::isfinite((*certain)[0].standard_error_pitch));
  } else {
    EXPECT_EQ(certain.error().code, ErrorCode::invalid_input) << certain.error().message;
  }

  const SensorSpec noisy;
  TemplateObserver usual = observer_with(0.07);
  const auto drowned = direct_estimate(noisy, full_plan(noisy, {}, {}), usual, {7e-5}, {.accuracy = accuracy});

  ASSERT_FALSE(drowned);
  EXPECT_EQ(drowned.error().code, ErrorCode::invalid_input);
  EXPECT_NE(drowned.error().message.find("no size"), std::string::npos) << drowned.error().message;
}

// Hard: contrasts from far below the noise to far above it; powers of ratios of noise, logarithms of nothing.
TEST(SensorExtremes, PlansOfEveryContrastAreNumbersOrRefusals) {
  const SensorSpec sensor;
  int planned = 0;
  for (const double delta_t_k : {1e-300, 1e-9, 1e-3, 0.03, 1.0, 400.0}) {
    TemplateObserver observer({}, triangle_alternatives());

    const auto plan = plan_effects(sensor, observer, {.delta_t_k = {delta_t_k}, .motion = {}}, {});

    if (!plan) {
      EXPECT_NE(plan.error().message.find("no identifiable threshold"), std::string::npos) << delta_t_k;
      continue;
    }
    ++planned;
    for (const ContrastOutlook& outlook : plan->outlooks) {
      EXPECT_TRUE(std::isfinite(outlook.s75_pitch) && std::isfinite(outlook.weibull_slope) &&
                  std::isfinite(outlook.noise_exponent) && std::isfinite(outlook.blur_exponent))
          << delta_t_k;
    }
    for (const auto& decision : plan->plan.decisions)
      EXPECT_TRUE(std::isfinite(decision.predicted_change_percent.value_or(0))) << delta_t_k;
  }
  EXPECT_GE(planned, 2);
}

// Sums in a fixed order and random numbers by place: two threads that share model and observer find the bits of one.
TEST(SensorExtremes, TwoThreadsFindTheBitsOfOne) {
  const SensorSpec spec;
  const SensorPlan plan = full_plan(spec, {}, {});
  const auto estimate = [&](TemplateObserver& observer) {
    return direct_estimate(spec, plan, observer, {1.93}, {.accuracy = Accuracy::draft()}).value()[0];
  };
  TemplateObserver alone = observer_with(0.07), shared = observer_with(0.07);
  const DirectPoint expected = estimate(alone);
  const SensorModel single = model(spec), both = model(spec);
  const cv::Mat1w frame = single.expose(scene_of_one(1.93), 5);

  DirectPoint first, second;
  cv::Mat1w frame_first, frame_second;
  {
    std::jthread one([&] { first = estimate(shared), frame_first = both.expose(scene_of_one(1.93), 5); });
    std::jthread two([&] { second = estimate(shared), frame_second = both.expose(scene_of_one(1.93), 5); });
  }

  for (const DirectPoint& found : {first, second}) {
    EXPECT_EQ(found.s75_pitch, expected.s75_pitch);
    EXPECT_EQ(found.standard_error_pitch, expected.standard_error_pitch);
    EXPECT_EQ(found.proportion_correct, expected.proportion_correct);
  }
  EXPECT_EQ(cv::countNonZero(frame_first != frame), 0);
  EXPECT_EQ(cv::countNonZero(frame_second != frame), 0);
}

}  // namespace
}  // namespace todbench
