// SPDX-License-Identifier: GPL-3.0-or-later
// Stages picture to picture: what must not change anything does not, what is known comes out.
#include "sim_devices/module/picture_stage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "acquisition/base/rng.h"
#include "bench/enhance/enhancement.h"
#include "tod/registration/super_resolution.h"

namespace todbench {
namespace {

cv::Mat1f noise(cv::Size size, std::uint64_t index) {
  cv::Mat1f picture(size);
  RandomStream(3, "stages").sub(index).fill_normal({picture.ptr<float>(), picture.total()});
  return picture;
}

TEST(ChainStages, LeaveAPictureAsItIsAtTheirNeutralValues) {
  const cv::Mat1f picture = noise({40, 30}, 1);
  for (const auto& stage : {recursive_filter(1), sharpening(0)}) {
    (void)stage->process(noise({40, 30}, 2)).value();
    EXPECT_EQ(cv::norm(stage->process(picture).value(), picture, cv::NORM_INF), 0);
    EXPECT_EQ(stage->memory_frames(), 0);
  }
  const cv::Mat1f flat(30, 40, 7.0F);
  for (const auto& stage : {sharpening(2), median_filter(3), median_filter(5), clahe(2, 4), plateau_equalisation(1)})
    EXPECT_NEAR(cv::norm(stage->process(flat).value(), flat, cv::NORM_INF), 0, 1e-5);
}

TEST(ChainStages, OfRecursionLeaveTheVarianceOfTheirClosedForm) {
  const double share = 0.25;
  const auto stage = recursive_filter(share);
  cv::Mat1f answer;
  for (int i = 0; i <= stage->memory_frames(); ++i)
    answer = stage->process(noise({320, 240}, static_cast<std::uint64_t>(i))).value();

  cv::Scalar mean, deviation;
  cv::meanStdDev(answer, mean, deviation);
  // The variance of so many independent values has a relative standard error of sqrt(2 / 76800) = 0.5 %.
  EXPECT_NEAR(deviation[0] * deviation[0] / (share / (2 - share)), 1, 0.02);
  EXPECT_EQ(stage->memory_frames(), 25);  // 0.75^25 = 0.00075
}

TEST(ChainStages, OfEqualisationKeepOrderAndRange) {
  const cv::Mat1f picture = 300 + noise({64, 48}, 4);
  double low = 0, high = 0, new_low = 0, new_high = 0;
  cv::minMaxLoc(picture, &low, &high);
  const cv::Mat1f answer = plateau_equalisation(5)->process(picture).value();

  cv::minMaxLoc(answer, &new_low, &new_high);
  EXPECT_GE(new_low, low);
  EXPECT_LE(new_high, high);
  for (int i = 1; i < 500; ++i) {
    const float a = *(picture.begin() + i), b = *(picture.begin() + i - 1);
    const float new_a = *(answer.begin() + i), new_b = *(answer.begin() + i - 1);
    EXPECT_TRUE(a == b || (a < b ? new_a <= new_b : new_a >= new_b));
  }
  // Without a limit by class the answer is uniform: half of it below the middle, within sqrt(1 / 4 / 3072) = 0.9 %.
  const cv::Mat1f uniform = plateau_equalisation(100)->process(picture).value();
  const double middle = (low + high) / 2;
  EXPECT_NEAR(cv::countNonZero(uniform < middle) / 3072.0, 0.5, 0.03);
}

/// A bright square with soft edges, displaced.
cv::Mat1f soft_square(cv::Point2d displaced) {
  cv::Mat1f picture(48, 64);
  for (int j = 0; j < picture.rows; ++j) {
    for (int i = 0; i < picture.cols; ++i) {
      const double x = i - 30.3 - displaced.x, y = j - 22.8 - displaced.y;
      picture(j, i) = static_cast<float>(300 + 10 * std::exp(-(std::pow(x / 9, 4) + std::pow(y / 7, 4))));
    }
  }
  return picture;
}

TEST(SuperResolutionStage, GivesWhatTheLibraryGivesOfTheLastFrames) {
  for (const FrameShifts kind : {FrameShifts::scan, FrameShifts::measured}) {
    const auto stage = super_resolution_stage({.frames = 4, .factor = 2, .shifts = kind});
    std::vector<cv::Mat1f> all;
    cv::Mat1f answer;
    for (std::uint64_t k = 0; k < 6; ++k) {
      all.push_back(soft_square(dither_px(2, k)) + 0.01 * noise({64, 48}, k));
      answer = stage->process(all.back()).value();
      EXPECT_EQ(answer.size(), cv::Size(128, 96)) << "also before there are four";
    }

    const std::vector<cv::Mat1f> last(all.begin() + 2, all.end());
    std::vector<cv::Point2d> shifts;
    for (std::uint64_t k = 2; k < 6; ++k) shifts.push_back(dither_px(2, k) - dither_px(2, 2));
    if (kind == FrameShifts::measured) shifts = frame_shifts(last).value();
    const auto library = super_resolve(last, shifts);
    ASSERT_TRUE(library) << library.error().message;
    EXPECT_EQ(cv::norm(answer, library->picture, cv::NORM_INF), 0);
    cv::Point2d mean(0, 0);
    for (const auto& shift : shifts) mean += shift / 4.0;
    EXPECT_EQ(stage->first_px(), library->first_px + mean);
    EXPECT_EQ(stage->memory_frames(), 3);
  }
  const auto stage = super_resolution_stage({});
  for (int k = 0; k < 3; ++k) (void)stage->process(soft_square({0, 0})).value();
  const auto never_moved = stage->process(soft_square({0, 0}));
  ASSERT_FALSE(never_moved) << "three cells of a pixel have no frame";
  EXPECT_EQ(never_moved.error().code, ErrorCode::not_identifiable);
}

}  // namespace
}  // namespace todbench
