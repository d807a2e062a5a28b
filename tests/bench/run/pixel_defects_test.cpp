// SPDX-License-Identifier: GPL-3.0-or-later
// Defects of single pixels: found where they are, and nowhere else.
#include "tod/measures/pixel_defects.h"

#include <gmock/gmock.h>

#include "bench/plan/plan_options.h"
#include "tests/bench/run/pixel_coverage.h"
#include "tod/camera_measures/pixel_measure.h"

namespace todbench {
namespace {

/// Frames of white noise of 1 round 100.
std::vector<cv::Mat1f> white_frames(int count, cv::Size size = {48, 32}) {
  std::vector<cv::Mat1f> frames;
  for (int k = 0; k < count; ++k) {
    cv::Mat1f frame(size);
    RandomStream(11, "frames")
        .sub(static_cast<std::uint64_t>(k))
        .fill_normal(std::span(frame.ptr<float>(), frame.total()));
    frames.push_back(frame + 100.F);
  }
  return frames;
}

TEST(PixelDefects, AreFoundInSimulatedArraysAndNowhereElse) {
  testing::PixelCoverage sum;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) testing::add_pixel_coverage(sum, {}, seed);

  EXPECT_EQ(sum.not_tested, 0);
  for (std::size_t k = 0; k < sum.there.size(); ++k) {
    ASSERT_GT(sum.there[k], 20) << to_string(pixel_fault_kinds[k]);
    EXPECT_EQ(sum.found[k], sum.there[k]) << to_string(pixel_fault_kinds[k]);
  }
  ASSERT_GT(sum.substituted, 60);
  EXPECT_EQ(sum.substituted_found, sum.substituted);
  EXPECT_EQ(sum.substituted_by_chance, 0);
  // A level is beyond five standard deviations in 6e-7 of normal values: 0.05 of 96000 pixels; three happen in 2e-5 of
  // all runs.
  EXPECT_LE(sum.bad_by_chance, 2);
}

TEST(PixelDefects, ACopyIsToldFromItsSource) {
  auto frames = white_frames(64);
  const cv::Point copy(20, 10), mean_of_two(30, 20);
  for (cv::Mat1f& frame : frames) {
    frame(copy) = frame(10, 19);
    frame(mean_of_two) = (frame(20, 29) + frame(20, 31)) / 2;
  }

  const auto found = pixel_defects(frames, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  const cv::Mat1b& substituted = found->of(PixelDefect::substituted);
  EXPECT_EQ(cv::countNonZero(substituted), 2);
  EXPECT_EQ(substituted(copy), 255);
  EXPECT_EQ(substituted(mean_of_two), 255);
  EXPECT_EQ(cv::countNonZero(found->bad), 0);
}

TEST(PixelDefects, AStepOfTwoStandardDeviationsAndAHalfIsABlink) {
  auto frames = white_frames(64);
  for (std::size_t k = 24; k < 50; ++k) frames[k](5, 7) += 2.5F;

  const auto found = pixel_defects(frames, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(cv::countNonZero(found->of(PixelDefect::blinking)), 1);
  EXPECT_EQ(found->of(PixelDefect::blinking)(5, 7), 255);
  EXPECT_EQ(found->of(PixelDefect::noisy)(5, 7), 0);
}

TEST(PixelDefects, APixelThatJumpsByAThousandTakesNoneOfItsRowWithIt) {
  auto frames = white_frames(64);
  for (std::size_t k = 0; k < 64; k += 2) frames[k](5, 7) += 1000;

  const auto found = pixel_defects(frames, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(cv::countNonZero(found->defective), 1);
}

TEST(PixelDefects, ADeadPixelIsFoundByItsResponseWhereThatIsKnown) {
  const auto frames = white_frames(48);
  PixelScene scene;
  scene.responsivity = cv::Mat1d(32, 48, std::numeric_limits<double>::quiet_NaN());
  scene.responsivity(cv::Rect(10, 10, 8, 8)) = 1;
  scene.responsivity(12, 13) = 0.7, scene.responsivity(13, 13) = 0.8;

  const auto found = pixel_defects(frames, scene, {});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->response_tested, 64);
  EXPECT_EQ(cv::countNonZero(found->of(PixelDefect::unresponsive)), 1);
  EXPECT_EQ(found->of(PixelDefect::unresponsive)(12, 13), 255);
}

TEST(PixelDefects, OfTheChineseStandardAStrongResponseIsNoDefect) {
  const auto frames = white_frames(48);
  PixelScene scene;
  scene.responsivity = cv::Mat1d::ones(32, 48);
  scene.responsivity(12, 13) = 1.6, scene.responsivity(13, 13) = 0.49, scene.responsivity(14, 13) = 0.51;
  MeasuresPlan measures;
  const PixelDefectRules own{.bad = bad_pixel_rules(measures)};
  measures.pixel_rule = PixelRule::gbt_17444;
  const PixelDefectRules standard{.bad = bad_pixel_rules(measures)};

  const auto by_own = pixel_defects(frames, scene, own), by_standard = pixel_defects(frames, scene, standard);

  ASSERT_TRUE(by_own && by_standard);
  EXPECT_EQ(cv::countNonZero(by_own->of(PixelDefect::unresponsive)), 3);
  EXPECT_EQ(cv::countNonZero(by_standard->of(PixelDefect::unresponsive)), 1);
  EXPECT_EQ(by_standard->of(PixelDefect::unresponsive)(13, 13), 255);
}

TEST(PixelDefects, WhatFramesCannotShowIsSaid) {
  EXPECT_FALSE(pixel_defects(white_frames(15), {}, {}));
  EXPECT_FALSE(pixel_defects(white_frames(64, {48, 7}), {}, {}));
  EXPECT_FALSE(pixel_defects(white_frames(64), {.unit_per_count = 2.5}, {}));
  EXPECT_FALSE(pixel_defects(std::vector<cv::Mat1f>(64, cv::Mat1f::ones(32, 48)), {}, {}));
  auto broken = white_frames(64);
  broken[7](3, 3) = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(pixel_defects(broken, {}, {}));
  const auto few = pixel_defects(white_frames(20), {}, {});
  ASSERT_TRUE(few) << few.error().message;
  EXPECT_THAT(few->not_tested, ::testing::Contains(::testing::HasSubstr("blinking")));
}

TEST(PixelDefects, AreCountedByZonesWithTheWholeOfTheirClusters) {
  auto frames = white_frames(64);
  // Two that touch at a corner across the border of the zone, one alone inside, one alone outside.
  for (const cv::Point hot : {cv::Point(23, 15), cv::Point(24, 16), cv::Point(4, 4), cv::Point(40, 28)})
    for (cv::Mat1f& frame : frames) frame(hot) += 30;
  const ZoneArea left{"left", 0, 0, 0.5, 1};

  const auto found =
      measure_pixels(frames, {60, 40}, {0, 0, 48, 32}, {}, {.whole_frame = true, .rules = {}, .zones = {left}});

  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->zones.size(), 2u);
  const ZoneCount& whole = found->zones[0].count;
  EXPECT_EQ(whole.pixels, 60 * 40);
  EXPECT_EQ(whole.measured, 48 * 32);
  EXPECT_EQ(whole.bad, 4);
  EXPECT_EQ(whole.clusters, 1);
  EXPECT_EQ(whole.largest_cluster, 2);
  const ZoneCount& zone = found->zones[1].count;
  EXPECT_EQ(zone.pixels, 30 * 40);
  EXPECT_EQ(zone.measured, 30 * 32);
  EXPECT_EQ(zone.bad, 3);
  const auto none = measure_pixels(frames, {48, 32}, {0, 0, 48, 32}, {},
                                   {.whole_frame = true, .rules = {}, .zones = {{"right", 0.5, 0, 1, 1}}});
  ASSERT_TRUE(none) << none.error().message;
  // The pixel at (23, 15) is left of the middle, its cluster counts on both sides.
  EXPECT_EQ(none->zones[1].count.bad, 2);
  EXPECT_EQ(none->zones[1].count.clusters, 1);
  EXPECT_EQ(none->zones[1].count.largest_cluster, 2);
}

}  // namespace
}  // namespace todbench
