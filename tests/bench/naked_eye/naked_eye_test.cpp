// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "hvs/observer/naked_eye.h"
#include "hvs/shape/polygon_coverage.h"
#include "tests/bench/naked_eye/simulated_person.h"

namespace todbench::testing {
namespace {

using ::testing::HasSubstr;

NakedEyeTask task_at(const ViewedDisplay& display) {
  return {.model = hvs_2_at(display)};
}

TEST(NakedEyePictures, ShowTheMeanLuminanceOfEverySample) {
  ViewedDisplay display = calibrated_screen();
  display.luminance_white_cd_m2 = display.luminance_black_cd_m2 = 0;
  display.luminance_table = {0.3, 4, 30, 95, 210};
  display.veil_cd_m2 = 5;
  // Half a level of this display: rounding alone would show nothing, or twice as much.
  NakedEyeTask task = task_at(display);
  task.contrasts = {0.008};
  constexpr int pictures = 400, window = 16;
  cv::Mat1d sum = cv::Mat1d::zeros(window, window);
  double squares = 0, stated = 0;
  NakedEyeTrial trial{.contrast = 0.008, .size_samples = 6, .centroid = {0.2, -0.3}};
  const cv::Mat1d covered =
      pixel_coverage(triangle(6, Apex::up, cv::Point2d(window / 2.0, window / 2.0) + trial.centroid), {window, window});
  for (trial.number = 0; trial.number < pictures; ++trial.number) {
    const NakedEyePicture picture = naked_eye_picture(task, trial, window);
    sum += cv::Mat1d(picture.contrast);
    const cv::Mat1d error = cv::Mat1d(picture.contrast) - 0.008 * covered;
    squares += error.dot(error) / static_cast<double>(error.total());
    stated += picture.noise * picture.noise;
    for (int i = 0; i < window; ++i) {
      for (int j = 0; j < window; ++j) {
        const double level = picture.levels(i, j) / 255.0;
        const double luminance = luminance_cd_m2(display, level) + 5;
        EXPECT_NEAR(picture.contrast(i, j), luminance / adaptation_luminance_cd_m2(display) - 1, 1e-6);
      }
    }
  }
  const double sd = std::sqrt(stated / pictures);
  cv::Scalar mean, spread;
  cv::meanStdDev(sum / pictures - 0.008 * covered, mean, spread);
  EXPECT_NEAR(mean[0], 0, 4 * sd / std::sqrt(pictures * window * window));
  EXPECT_LT(spread[0], 1.3 * sd / std::sqrt(pictures));
  EXPECT_NEAR(std::sqrt(squares / pictures), sd, 0.02 * sd);
}

TEST(NakedEyePictures, CarryTheStatedWhiteNoise) {
  NakedEyeTask task = task_at(calibrated_screen());
  task.noise = 0.1;
  const NakedEyePicture picture = naked_eye_picture(task, {.contrast = 0.3, .size_samples = 2}, 96);
  cv::Scalar mean, sd;
  cv::meanStdDev(picture.contrast.rowRange(0, 36), mean, sd);
  EXPECT_NEAR(sd[0], picture.noise, 0.05 * picture.noise);
  EXPECT_GT(picture.noise, 0.1);
}

TEST(NakedEyePrediction, AgreesWithTheClosedFormOfAKnownPlace) {
  // Without search and sampling (hvs/observer/naked_eye.h); both cost least with small samples.
  ViewedDisplay display = calibrated_screen();
  display.zoom = 1;
  const NakedEyeTask task = task_at(display);
  const auto predicted = predict_naked_eye(task, 64, {});
  ASSERT_TRUE(predicted) << predicted.error().message;
  const EyeFilter filter(*task.model.eye, adaptation_luminance_cd_m2(*task.model.display));
  const NakedEyeShape shape(triangle(1, Apex::up));
  for (const NakedEyeContrast& one : predicted->contrasts) {
    const auto known = shape.threshold_deg(filter, task.model.eye->contrast_noise, one.contrast, 0.75);
    ASSERT_TRUE(known);
    const double found_deg = one.s75_mrad / 1000 * 180 / std::numbers::pi;
    EXPECT_GT(found_deg, 0.98 * *known) << one.contrast;
    EXPECT_LT(found_deg, 1.15 * *known) << one.contrast;
    EXPECT_LT(*one.spread_low_mrad, one.s75_mrad);
    EXPECT_GT(*one.spread_high_mrad, one.s75_mrad);
    EXPECT_LT(one.sizes.front().share, 0.5);
    EXPECT_GT(one.sizes.back().share, 0.95);
  }
}

TEST(NakedEyeSession, WritesThePredictionBeforeTheFirstAnswerAndItsComparisonAfterTheLast) {
  const TemporaryFolder folder;
  NakedEyeTask task = task_at(calibrated_screen());
  task.contrasts = {0.4, 0.1};
  task.per_size = 8;
  auto session = NakedEyeSession::begin(task, folder.path() / "eye", 32, {});
  ASSERT_TRUE(session) << session.error().message;
  const auto before = sha256_of_file(folder.path() / "eye" / naked_eye_name);
  EXPECT_EQ(session->planned(), 2u * naked_eye_sizes * 8);
  EXPECT_THAT(answered_naked_eye(folder.path() / "eye").error().message, HasSubstr("no answers"));

  TemplateObserverSpec person = task.model;
  person.display = linear_display(*task.model.display);
  answer_all(*session, person, 7);

  EXPECT_EQ(*before, *sha256_of_file(folder.path() / "eye" / naked_eye_name));
  EXPECT_EQ(session->comparison()["prediction_sha256"], *before);
  EXPECT_TRUE(session->comparison()["complete"]);
  // The person is the model itself.
  EXPECT_GT(session->comparison()["model"]["p"], 0.001);
  for (const Json& one : session->comparison()["contrasts"]) EXPECT_TRUE(one["inside_spread"]) << one.dump();
  const auto answered = answered_naked_eye(folder.path() / "eye");
  ASSERT_TRUE(answered) << answered.error().message;
  EXPECT_EQ(answered->human.trials.size(), session->planned());
  EXPECT_DOUBLE_EQ(luminance_contrast(*answered->display, 0.25).value(), 0.25);
  EXPECT_THAT(NakedEyeSession::begin(task, folder.path() / "eye", 32, {}).error().message, HasSubstr("exists"));
}

TEST(NakedEyeSession, RejectsAModelWhoseEyeIsFourTimesBetter) {
  const TemporaryFolder folder;
  NakedEyeTask task = task_at(calibrated_screen());
  task.contrasts = {0.1};
  task.per_size = 16;
  auto session = NakedEyeSession::begin(task, folder.path() / "eye", 32, {});
  ASSERT_TRUE(session) << session.error().message;
  TemplateObserverSpec person = task.model;
  person.display = linear_display(*task.model.display);
  person.eye->sensitivity /= 4;
  answer_all(*session, person, 3);
  EXPECT_LT(session->comparison()["model"]["p"], 1e-6);
  EXPECT_FALSE(session->comparison()["contrasts"][0]["inside_spread"]);
}

TEST(NakedEyeTask, RefusesWhatADisplayCannotShow) {
  const auto why = [](const NakedEyeTask& task) {
    const auto possible = validate(task);
    return possible ? std::string() : possible.error().message;
  };
  NakedEyeTask task = task_at(calibrated_screen());
  EXPECT_EQ(why(task), "");
  task.noise = 0.3;
  EXPECT_THAT(why(task), HasSubstr("cannot show a contrast of 0.4 with a noise of 0.3"));
  task.noise = -1;
  EXPECT_THAT(why(task), HasSubstr("expected 0 to 1"));
  task.noise = std::nan("");
  EXPECT_THAT(why(task), HasSubstr("expected 0 to 1"));
  task.noise = 0;
  task.contrasts = {1e-5};
  EXPECT_THAT(why(task), HasSubstr("at least 0.005"));
  task.contrasts = {};
  EXPECT_THAT(why(task), HasSubstr("no contrast"));
  task = task_at(calibrated_screen());
  task.model.display->viewing_distance_m = 600;
  EXPECT_THAT(why(task), HasSubstr("metres"));
  task.model.display.reset();
  EXPECT_THAT(why(task), HasSubstr("[display]"));
  task.model.eye.reset();
  EXPECT_THAT(why(task), HasSubstr("no eye"));
  task = task_at(calibrated_screen());
  task.model.display->viewing_distance_m = 0.05;
  EXPECT_THAT(why(task), HasSubstr("a displayed sample is 37.1 arcmin"));
}

}  // namespace
}  // namespace todbench::testing
