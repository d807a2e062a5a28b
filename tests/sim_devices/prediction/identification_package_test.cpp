// SPDX-License-Identifier: GPL-3.0-or-later
// Identification behind stages: what changes nothing, what a known filter does, what has no contrast.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "sim_devices/prediction/identification.h"
#include "tests/sim_devices/reference.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

using Stages = std::vector<std::unique_ptr<ChainStage>>;

FieldScene warm_triangle(Apex apex) {
  FieldScene scene;
  scene.background_k = 300;
  scene.regions = {{"triangle", triangle(1, apex), 300.6, 1, true}};
  return scene;
}

IdentificationTask four_triangles() {
  IdentificationTask task;
  task.sensor = test::sc2000();
  task.sensor.width = 64;
  task.sensor.height = 48;
  task.sensor.fixed_pattern_k = 0.02;
  task.plan = full_plan(task.sensor, {}, {});
  task.observer.search_range_samples = 0.25;
  task.observer.sensor_noise_factor = 1.3;
  task.accuracy = Accuracy::draft();
  for (const Apex apex : all_apexes)
    task.targets.push_back({std::to_string(static_cast<int>(apex)), {warm_triangle(apex)}});
  task.ranges = {{400, 1}};
  task.decisions = 320;
  task.stage_reach_px = 12;
  return task;
}

std::array<double, 9> middle_only(double gain) {
  return {0, 0, 0, 0, gain, 0, 0, 0, 0};
}

/// A stage of the test: any function of picture and memory.
class FunctionStage final : public ChainStage {
 public:
  explicit FunctionStage(std::function<cv::Mat1f(const cv::Mat1f&, cv::Mat1f&)> function, int memory_frames = 0)
      : function_(std::move(function)), memory_frames_(memory_frames) {}
  Result<cv::Mat1f> process(const cv::Mat1f& picture) override { return function_(picture, memory_); }
  [[nodiscard]] int memory_frames() const override { return memory_frames_; }

 private:
  std::function<cv::Mat1f(const cv::Mat1f&, cv::Mat1f&)> function_;
  cv::Mat1f memory_;
  int memory_frames_;
};

/// x of y = x + (x - mean of 3 x 3), as sharpening(1): x = (y + mean of x) / 2, by iteration.
std::unique_ptr<ChainStage> unsharpening() {
  return std::make_unique<FunctionStage>([](const cv::Mat1f& picture, cv::Mat1f&) {
    cv::Mat1d y, mean;
    picture.convertTo(y, CV_64F);
    cv::Mat1d x = y.clone();
    for (int i = 0; i < 40; ++i) {
      cv::blur(x, mean, {3, 3}, {-1, -1}, cv::BORDER_REPLICATE);
      x = (y + mean) / 2;
    }
    return cv::Mat1f(x);
  });
}

/// x_n of y_n = x_n / 4 + 3/4 y_(n-1), as recursive_filter(0.25).
std::unique_ptr<ChainStage> unrecursive() {
  return std::make_unique<FunctionStage>(
      [](const cv::Mat1f& picture, cv::Mat1f& before) {
        const cv::Mat1f answer = before.empty() ? picture.clone() : cv::Mat1f(4 * picture - 3 * before);
        before = picture.clone();
        return answer;
      },
      1);
}

IdentificationPoint point_of(const IdentificationTask& task) {
  auto found = identify(task);
  EXPECT_TRUE(found) << found.error().message;
  return found ? found->front() : IdentificationPoint{.answers = {}, .by_draw = {0}};
}

TEST(IdentificationBehindStages, AGainAndAnInvertedPictureChangeNoAnswer) {
  IdentificationTask task = four_triangles();
  task.stage_reach_px = 0;  // the same window has the same noise without stages
  const auto bare = point_of(task);
  const auto behind = [&](double gain) {
    task.stages = [gain] {
      Stages stages;
      stages.push_back(kernel_filter(middle_only(gain)));
      return stages;
    };
    return point_of(task);
  };
  const auto same = behind(1), enlarged = behind(3), inverted = behind(-0.5);

  EXPECT_EQ(enlarged.answers, same.answers);
  EXPECT_EQ(inverted.answers, same.answers);
  ASSERT_TRUE(enlarged.judged && inverted.judged);
  EXPECT_NEAR(enlarged.judged->gain, 3, 0.01);
  EXPECT_NEAR(inverted.judged->gain, -0.5, 0.002);
  EXPECT_NEAR(enlarged.judged->noise_k, task.sensor.netd_k, 0.003);
  EXPECT_FALSE(bare.judged);
  // Without stages counts are rounded with the noise only.
  EXPECT_NEAR(same.proportion(), bare.proportion(), 0.01);
  EXPECT_GT(bare.proportion(), 0.5);
  EXPECT_LT(bare.proportion(), 0.95);
}

TEST(IdentificationBehindStages, AFilterAndItsInverseChangeNoAnswer) {
  IdentificationTask task = four_triangles();
  task.stages = [] {
    Stages stages;
    stages.push_back(kernel_filter(middle_only(1)));
    return stages;
  };
  const auto same = point_of(task);
  task.stages = [] {
    Stages stages;
    stages.push_back(sharpening(1));
    stages.push_back(unsharpening());
    return stages;
  };
  EXPECT_EQ(point_of(task).answers, same.answers);
  // In a pass of several frames of a target in motion.
  task.sequence = SequenceObserver::tracking_sum;
  task.frames = 3;
  task.decisions = 48;
  task.motion = {.x_mrad_s = 50, .y_mrad_s = 20};
  task.plan = full_plan(task.sensor, {}, {}, task.motion);
  const auto filtered = [&](bool with_inverse, int lead) {
    task.stages = [=] {
      Stages stages;
      if (with_inverse) {
        stages.push_back(recursive_filter(0.25));
        stages.push_back(unrecursive());
      } else {
        stages.push_back(std::make_unique<FunctionStage>(
            [](const cv::Mat1f& picture, cv::Mat1f&) { return picture.clone(); }, lead));
      }
      return stages;
    };
    return point_of(task);
  };
  // As many frames before the pass have the same random numbers.
  const int lead = recursive_filter(0.25)->memory_frames() + 1;
  EXPECT_EQ(filtered(true, lead).answers, filtered(false, lead).answers);
}

// A recursive filter at rest is a mean of frames with less noise; a target in motion lags and is smeared.
TEST(IdentificationBehindStages, ARecursiveFilterHelpsAtRestAndHarmsInMotion) {
  IdentificationTask task = four_triangles();
  task.ranges = {{500, 1}};
  const auto still = point_of(task);
  const auto recursive = [&](SceneMotion motion) {
    task.motion = motion;
    task.plan = full_plan(task.sensor, {}, {}, motion);
    task.stages = [] {
      Stages stages;
      stages.push_back(recursive_filter(0.25));
      return stages;
    };
    return point_of(task);
  };
  const auto at_rest = recursive({}), moving = recursive({.x_mrad_s = 60, .y_mrad_s = 0});

  EXPECT_GT(at_rest.proportion(), still.proportion());
  EXPECT_NEAR(at_rest.judged->gain, 1, 1e-3);
  // The variance of white noise is reduced to share / (2 - share).
  EXPECT_NEAR(at_rest.judged->noise_k / task.sensor.netd_k, std::sqrt(0.25 / 1.75), 0.03);
  EXPECT_LT(moving.proportion(), at_rest.proportion() - 0.1);
}

// A stage that needs the whole picture receives that of the camera.
TEST(IdentificationBehindStages, GivesGainControlTheWholePicture) {
  IdentificationTask task = four_triangles();
  task.decisions = 64;
  task.stage_reach_px.reset();
  auto size = std::make_shared<cv::Size>();
  task.stages = [size] {
    Stages stages;
    stages.push_back(std::make_unique<FunctionStage>([size](const cv::Mat1f& picture, cv::Mat1f&) {
      *size = picture.size();
      return picture.clone();
    }));
    stages.push_back(gain_control(0));
    return stages;
  };
  const auto found = point_of(task);

  EXPECT_EQ(*size, cv::Size(64, 48));
  ASSERT_TRUE(found.judged);
  EXPECT_NE(found.judged->gain, 1);
  EXPECT_GT(found.proportion(), 0.4);
  task.ranges = {{10, 1}};
  EXPECT_EQ(identify(task).error().code, ErrorCode::invalid_input) << "the target is larger than the picture";
}

TEST(IdentificationBehindStages, RefusesPicturesWithoutContrastAndClippedOnes) {
  IdentificationTask task = four_triangles();
  task.stages = [] {
    Stages stages;
    stages.push_back(kernel_filter(middle_only(0)));
    return stages;
  };
  auto found = identify(task);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::not_identifiable);
  task.stages = [] {
    Stages stages;
    stages.push_back(recursive_filter(0.5));
    return stages;
  };
  task.sensor.offset_k = 300.2;
  task.plan = full_plan(task.sensor, {}, {});
  found = identify(task);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::invalid_input);
}

}  // namespace
}  // namespace todbench
