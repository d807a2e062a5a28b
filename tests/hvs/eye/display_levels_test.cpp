// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/eye/display_levels.h"

#include <gtest/gtest.h>

#include <cmath>

namespace todbench {
namespace {

ViewedDisplay dim_monitor() {
  return {.pixel_pitch_mm = 0.25,
          .viewing_distance_m = 0.6,
          .luminance_white_cd_m2 = 180,
          .luminance_black_cd_m2 = 0.5,
          .veil_cd_m2 = 4,
          .zoom = 3,
          .contrast = 0.4};
}

/// A flat background with one sample of `kelvin` in the middle.
cv::Mat1d one_sample(double kelvin) {
  cv::Mat1d picture = cv::Mat1d::zeros(5, 5);
  picture(2, 2) = kelvin;
  return picture;
}

double contrast_of_middle(const ViewedDisplay& display, double kelvin, double contrast_k) {
  const cv::Mat1b levels = operator_picture(display, one_sample(kelvin), contrast_k);
  return level_contrasts(display)[levels(levels.rows / 2, levels.cols / 2)];
}

TEST(DisplayLevels, ShowATargetWithTheContrastOfTheModel) {
  ViewedDisplay display = dim_monitor();
  // Half a level is about 0.5 %.
  EXPECT_NEAR(contrast_of_middle(display, 2, 2), shown_contrast(display, 2), 0.008);
  EXPECT_NEAR(contrast_of_middle(display, -2, -2), -shown_contrast(display, -2), 0.008);
  EXPECT_NEAR(contrast_of_middle(display, 1, 2), shown_contrast(display, 2) / 2, 0.008);

  display.span_k = 20;
  const double hot = contrast_of_middle(display, 3, 3), cold = contrast_of_middle(display, -3, -3);
  EXPECT_NEAR((hot - cold) / 2, luminance_contrast(display, 3).value(), 0.008);
}

TEST(DisplayLevels, PutTheBackgroundInTheMiddleOfTheLuminances) {
  const ViewedDisplay display = dim_monitor();
  const int level = background_level_of(display);
  EXPECT_NEAR(luminance_cd_m2(display, level / 255.0), (180 + 0.5) / 2, 1);
  EXPECT_NEAR(level_contrasts(display)[static_cast<std::size_t>(level)], 0, 0.008);
  EXPECT_EQ(operator_picture(display, one_sample(0), 1)(0, 0), level);
}

TEST(DisplayLevels, EnlargeSamplesByTheInterpolationOfTheDisplay) {
  ViewedDisplay display = dim_monitor();
  const cv::Mat1b held = operator_picture(display, one_sample(1), 1);
  ASSERT_EQ(held.size(), cv::Size(15, 15));
  const int background = background_level_of(display);
  EXPECT_EQ(cv::countNonZero(held != background), 9);

  display.interpolation = DisplayInterpolation::linear;
  const cv::Mat1b smooth = operator_picture(display, one_sample(1), 1);
  EXPECT_EQ(smooth(7, 7), held(7, 7));
  EXPECT_GT(cv::countNonZero(smooth != background), 20);
}

TEST(DisplayLevels, AreCutAtBlackAndWhite) {
  ViewedDisplay display = dim_monitor();
  for (const double span_k : {0.0, 1.0}) {
    display.span_k = span_k;
    EXPECT_EQ(operator_picture(display, one_sample(100), 1)(7, 7), 255);
    EXPECT_EQ(operator_picture(display, one_sample(-100), 1)(7, 7), 0);
  }
}

}  // namespace
}  // namespace todbench
