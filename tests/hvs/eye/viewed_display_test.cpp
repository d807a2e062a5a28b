// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/eye/viewed_display.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

namespace todbench {
namespace {

using ::testing::HasSubstr;

ViewedDisplay monitor() {
  return {.pixel_pitch_mm = 0.25, .viewing_distance_m = 0.6, .luminance_white_cd_m2 = 100};
}

std::string refusal(const ViewedDisplay& display) {
  const auto possible = validate(display);
  return possible ? "" : possible.error().message;
}

TEST(ViewedDisplay, HasTheAngleOfASample) {
  ViewedDisplay display = monitor();
  // 0.25 mm at 600 mm.
  EXPECT_NEAR(arcmin_per_sample(display), 2 * std::atan(0.125 / 600) * 60 * 180 / std::numbers::pi, 1e-12);
  EXPECT_NEAR(arcmin_per_sample(display), 1.432394, 1e-5);

  display.zoom = 4;

  EXPECT_NEAR(arcmin_per_sample(display), 4 * 1.432394, 1e-4);
}

TEST(ViewedDisplay, TakesThePitchFromTheDiagonal) {
  ViewedDisplay display = monitor();
  display.pixel_pitch_mm = 0;
  display.diagonal_in = 20;
  display.pixels = {1600, 1200};  // a diagonal of 2000 pixels

  ASSERT_TRUE(validate(display));
  EXPECT_NEAR(pixel_pitch_mm(display), 0.254, 1e-12);
}

TEST(ViewedDisplay, ShowsTheContrastThatTheOperatorSets) {
  EXPECT_EQ(luminance_contrast(monitor(), 0.01).value(), 0.5);
  EXPECT_EQ(luminance_contrast(monitor(), -20).value(), 0.5);
  EXPECT_EQ(adaptation_luminance_cd_m2(monitor()), 50);
}

TEST(ViewedDisplay, LosesContrastToTheVeil) {
  ViewedDisplay display = monitor();
  display.luminance_black_cd_m2 = 1;
  EXPECT_NEAR(largest_contrast(display), 49.5 / 50.5, 1e-12);

  display.veil_cd_m2 = 50;

  EXPECT_NEAR(largest_contrast(display), 49.5 / 100.5, 1e-12);
  EXPECT_THAT(refusal(display), HasSubstr("the display cannot show a luminance contrast of 0.5"));
}

TEST(ViewedDisplay, ShowsKelvinAtAFixedGain) {
  ViewedDisplay display = monitor();
  display.gamma = 1;
  display.span_k = 10;
  // A linear display: 1 K is a tenth of 100 cd/m2 on a background of 50 cd/m2.
  EXPECT_NEAR(luminance_contrast(display, 1).value(), 0.2, 1e-12);
  EXPECT_FALSE(luminance_contrast(display, 6));

  display.gamma = 2;

  // The background is at level sqrt(1/2), where the slope is sqrt(2) times the range.
  EXPECT_NEAR(luminance_contrast(display, 0.01).value(), 0.001 * std::numbers::sqrt2 * 100 / 50, 1e-9);
}

TEST(ViewedDisplay, ReadsATableLikeAGamma) {
  ViewedDisplay by_gamma = monitor(), by_table = monitor();
  by_gamma.span_k = by_table.span_k = 10;
  by_table.luminance_white_cd_m2 = 0;
  for (int i = 0; i <= 1000; ++i) by_table.luminance_table.push_back(100 * std::pow(i / 1000.0, 2.2));

  ASSERT_TRUE(validate(by_table));
  EXPECT_NEAR(luminance_contrast(by_table, 1).value(), luminance_contrast(by_gamma, 1).value(), 1e-5);
}

TEST(ViewedDisplay, IsSharperWithoutSpotAndInterpolation) {
  ViewedDisplay sharp = monitor(), spot = monitor(), linear = monitor();
  spot.spot_mm = 0.1;
  linear.zoom = sharp.zoom = 4;
  linear.interpolation = DisplayInterpolation::linear;

  EXPECT_EQ(display_transfer(sharp, 0, 0), 1);
  EXPECT_EQ(display_transfer(spot, 0, 0), 1);
  EXPECT_NEAR(display_transfer(sharp, 0.5, 0), 2 / std::numbers::pi, 1e-12);
  EXPECT_LT(display_transfer(spot, 0.5, 0), display_transfer(monitor(), 0.5, 0));
  EXPECT_LT(display_transfer(linear, 0.5, 0), display_transfer(sharp, 0.5, 0));
}

TEST(ViewedDisplay, RefusesWhatCannotBeViewed) {
  const auto with = [](auto change) {
    ViewedDisplay display = monitor();
    change(display);
    return refusal(display);
  };
  EXPECT_EQ(with([](auto&) {}), "");
  EXPECT_THAT(with([](auto& d) { d.viewing_distance_m = 600; }), HasSubstr("state 0.6 for 600 mm"));
  EXPECT_THAT(with([](auto& d) { d.viewing_distance_m = 0; }), HasSubstr("viewing_distance_m"));
  EXPECT_THAT(with([](auto& d) { d.luminance_white_cd_m2 = 0; }), HasSubstr("luminance_white_cd_m2"));
  EXPECT_THAT(with([](auto& d) { d.luminance_black_cd_m2 = 100; }), HasSubstr("brighter than black"));
  EXPECT_THAT(with([](auto& d) { d.pixel_pitch_mm = 0; }), HasSubstr("pixel_pitch_mm"));
  EXPECT_THAT(with([](auto& d) { d.diagonal_in = 20; }), HasSubstr("either"));
  EXPECT_THAT(with([](auto& d) { d.pixel_pitch_mm = std::nan(""); }), HasSubstr("pixel_pitch_mm"));
  EXPECT_THAT(with([](auto& d) { d.contrast = 1.2; }), HasSubstr("cannot show"));
  EXPECT_THAT(with([](auto& d) { d.zoom = 1.5; }), HasSubstr("zoom"));
  EXPECT_THAT(with([](auto& d) {
                d.luminance_white_cd_m2 = 0;
                d.luminance_table = {0, 20, 10, 100};
              }),
              HasSubstr("the luminance falls from 20 to 10 cd/m2 at value 3"));
}

TEST(ViewedDisplay, WarnsOfSamplesThatTheEyeHardlyResolves) {
  ViewedDisplay display = monitor();
  display.viewing_distance_m = 0.6;
  display.pixel_pitch_mm = 0.157;

  EXPECT_THAT(small_sample_warning(display).value_or(""),
              HasSubstr("at 0.6 m a displayed sample is 0.9 arcmin: the eye, not the camera, will limit this test"));

  display.zoom = 4;

  EXPECT_FALSE(small_sample_warning(display));
}

}  // namespace
}  // namespace todbench
