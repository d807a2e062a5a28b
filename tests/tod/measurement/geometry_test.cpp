// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/geometry.h"

#include <gmock/gmock.h>

#include "tests/tod/measurement/faulty_bench.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

using test::SmallBench;

constexpr int width = 320, height = 240;

std::vector<Misfit> misfits_of(const SmallBench& bench) {
  TemplateObserver observer(TemplateObserverSpec{}, triangle_alternatives());
  auto found = find_misfits(test::options_of(bench), observer, {width, height});
  EXPECT_TRUE(found) << found.error().message;
  return found.value_or(std::vector<Misfit>());
}

TEST(Geometry, WhatFitsHasNoMisfit) {
  EXPECT_TRUE(misfits_of(SmallBench()).empty());
}

TEST(Geometry, TrianglesTooNearAreNamedWithTheirGap) {
  SmallBench bench;
  auto& triangles = bench.plates.front().triangles;
  triangles[1].position_mm = triangles[0].position_mm + cv::Point2d(26, 0);

  const auto misfits = misfits_of(bench);

  ASSERT_FALSE(misfits.empty());
  const auto* near = std::get_if<TrianglesTooNear>(&misfits.front());
  ASSERT_NE(near, nullptr);
  EXPECT_EQ(near->plate, bench.plates.front().name);
  EXPECT_EQ(near->window.triangle, triangles[0].name);
  EXPECT_EQ(near->window.neighbour, triangles[1].name);
  EXPECT_LT(near->window.gap_px, near->window.least_gap_px);
}

TEST(Geometry, APlateLargerThanThePictureComesBeforeWhatItExplains) {
  SmallBench bench;
  auto& plate = bench.plates.front();
  plate.triangles[1].position_mm = plate.triangles[0].position_mm + cv::Point2d(26, 0);
  plate.width_mm = 2000;

  const auto misfits = misfits_of(bench);

  ASSERT_GE(misfits.size(), 2U);
  const auto* large = std::get_if<PlateBeyondPicture>(&misfits.front());
  ASSERT_NE(large, nullptr);
  EXPECT_EQ(large->plate, plate.name);
  EXPECT_NEAR(large->size_px.width, 2000 / (bench.distance_m * bench.spec.ifov_mrad()), 1e-9);
  EXPECT_EQ(large->picture, cv::Size(width, height));
  EXPECT_TRUE(std::holds_alternative<TrianglesTooNear>(misfits[1]));
}

TEST(Geometry, SaysAFewMisfitsAndHowManyMoreThereAre) {
  const Misfit misfit = PlateBeyondPicture{"p", {400, 300}, {800, 600}, 2, {640, 480}};

  EXPECT_EQ(sentences({misfit}, 3),
            "plate p: its 400 x 300 mm cover 800 x 600 pixels at 2.00 m, but the picture has 640 x 480 pixels");
  EXPECT_THAT(sentences({misfit, misfit, misfit}, 1), ::testing::EndsWith("640 x 480 pixels; and 2 more"));
}

}  // namespace
}  // namespace todbench
