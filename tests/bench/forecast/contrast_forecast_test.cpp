// SPDX-License-Identifier: GPL-3.0-or-later
// What the measured contrast adds to the interval of S75 before it is measured.
#include "bench/forecast/contrast_forecast.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "acquisition/base/rng.h"
#include "bench/forecast/precision_frontier.h"
#include "bench/plan/descriptions.h"
#include "tests/tod/registration/plate_picture.h"

namespace todbench {
namespace {

// Witness: effective_contrast() of 300 pictures of white noise, without triangles.
TEST(ContrastForecast, HasTheVarianceOfTheEstimator) {
  struct Row {
    const char* name;
    double min_size_px;
  };
  for (const auto& [name, min_size_px] : {Row{"tcat-a", 4}, Row{"tcat-b", 4}, Row{"tcat-c", 6}, Row{"tcat-d", 6}}) {
    const TargetPlate plate = load_plate(name).value();
    testing::PictureSpec spec{.size = {180, 200}, .centre_px = {89.8, 99.7}};
    Registration registration;
    registration.plate_to_pixel = testing::true_mapping(spec);
    registration.scale_px_per_mm = spec.scale;
    constexpr int pictures = 300;
    double squares = 0;
    for (int i = 0; i < pictures; ++i) {
      cv::Mat1d picture(spec.size);
      const RandomStream noise(static_cast<std::uint64_t>(i), "contrast_forecast");
      for (std::size_t k = 0; k < picture.total(); ++k)
        picture(static_cast<int>(k) / picture.cols, static_cast<int>(k) % picture.cols) = noise.normal(k);
      const auto seen = effective_contrast(picture, plate, registration, min_size_px);
      ASSERT_TRUE(seen) << seen.error().message;
      squares += seen->value * seen->value / pictures;
    }
    // Four standard errors of a variance of 300 are 33 %; medians of few pixels are better than their asymptote.
    EXPECT_NEAR(contrast_variance_per_pixel(plate, spec.scale, min_size_px) / squares, 1.1, 0.35) << name;
  }
}

TEST(ContrastForecast, ReferenceTrianglesHaveAQuarterOfTheVariance) {
  const auto variance = [](const char* name, double min_size_px) {
    return contrast_variance_per_pixel(load_plate(name).value(), testing::expected_scale, min_size_px);
  };
  EXPECT_LT(variance("tcat-c", 6), 0.25 * variance("tcat-a", 4));
  EXPECT_LT(variance("tcat-d", 6), 0.25 * variance("tcat-b", 4));
}

Plan plan_with_camera(int contrast_frames) {
  Plan plan;
  plan.camera.id = "sim:sc2000";
  plan.camera.ifov_mrad = load_sensor("sc2000")->ifov_mrad();
  plan.simulation.accuracy = "draft";
  plan.measurement.contrast_frames = contrast_frames;
  return plan;
}

ContrastPrediction lowest(const Plan& plan) {
  EffectPlanner planner;
  const auto inputs = experiment_inputs(LoadedPlan::load(plan).value(), planner).value();
  return predict_plan(as_measured(plan), inputs).value().contrasts.back();
}

TEST(ContrastForecast, FollowsTheFramesOfTheContrastAndIsNoneOfASimulation) {
  const ContrastPrediction one = lowest(plan_with_camera(1)), many = lowest(plan_with_camera(400));
  Plan simulated = plan_with_camera(1);
  simulated.camera.id.clear();

  ASSERT_EQ(one.delta_t_k, 0.23);
  EXPECT_NEAR(one.contrast_half_width / many.contrast_half_width, 20, 0.01);
  EXPECT_GT(*one.uncertainty_percent, 2 * *many.uncertainty_percent);
  EXPECT_EQ(lowest(simulated).contrast_half_width, 0);
  EXPECT_LT(*lowest(simulated).uncertainty_percent, *many.uncertainty_percent);
}

TEST(ContrastForecast, OfPresentationsWithOwnContrastsIsReducedByEachOfThem) {
  Plan plan = plan_with_camera(1);
  plan.target.kind = TargetKind::scpi;
  plan.target.black_body = plan.target.stage = "127.0.0.1:1";
  const double once = *lowest(plan).uncertainty_percent;
  plan.target.contrast_settling_band_percent = 10;

  const ContrastPrediction own = lowest(plan);

  EXPECT_LT(*own.uncertainty_percent, once / 2);
  EXPECT_EQ(own.contrast_half_width, 0) << "more presentations reduce it";
}

TEST(PredictPlan, PromisesNothingAtAContrastBeyondTheRangeOfTheSensor) {
  Plan plan = plan_with_camera(16);
  plan.target.delta_t_k = {10, 0.23};
  EffectPlanner planner;
  auto inputs = experiment_inputs(LoadedPlan::load(plan).value(), planner).value();
  const PlanPrediction whole = predict_plan(as_measured(plan), inputs).value();
  inputs.sensor.offset_k = 295, inputs.sensor.bits = 10;  // to 305.23 K, in a surround of 300 K

  const PlanPrediction cut = predict_plan(as_measured(plan), inputs).value();

  ASSERT_EQ(cut.contrasts.size(), 2u);
  EXPECT_TRUE(whole.contrasts[0].uncertainty_percent);
  EXPECT_FALSE(cut.contrasts[0].uncertainty_percent);
  EXPECT_FALSE(cut.contrasts[0].paired_se_ln_ratio);
  EXPECT_FALSE(cut.figures.predicted_uncertainty_percent);
  EXPECT_TRUE(cut.contrasts[1].uncertainty_percent);
  ASSERT_EQ(cut.warnings.size(), whole.warnings.size() + 1);
  EXPECT_THAT(cut.warnings.back(), ::testing::HasSubstr("310 K in a surround of 300 K leaves the range"));

  plan.schedule.kind = ScheduleKind::adaptive;
  const PlanPrediction adaptive = predict_plan(as_measured(plan), inputs).value();
  EXPECT_FALSE(adaptive.contrasts[0].uncertainty_percent) << "the schedule goes on to its cap";
  EXPECT_TRUE(adaptive.contrasts[1].stopped_at_percent);
}

}  // namespace
}  // namespace todbench
