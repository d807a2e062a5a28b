// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/plate/test_pattern.h"

#include <gtest/gtest.h>

#include <cmath>

namespace todbench {
namespace {

/// Shoelace formula.
double enclosed(const Polygon& p) {
  double twice = 0;
  for (std::size_t i = 0; i < p.size(); ++i) twice += p[i].cross(p[(i + 1) % p.size()]);
  return std::abs(twice) / 2;
}

TEST(TestPattern, ConstantsAreThoseOfAnEquilateralTriangleOfUnitArea) {
  // area = sqrt(3) / 4 side^2 = 1. One or two units in the last place of numbers near 1.
  constexpr double tolerance = 1e-15;

  EXPECT_NEAR(triangle_side, 2 / std::pow(3.0, 0.25), tolerance);
  EXPECT_NEAR(triangle_height, std::pow(3.0, 0.25), tolerance);
  EXPECT_NEAR(triangle_centroid_to_apex, 2 * std::pow(3.0, 0.25) / 3, tolerance);
  EXPECT_NEAR(triangle_centroid_to_base, std::pow(3.0, 0.25) / 3, tolerance);
}

TEST(TestPattern, SizeIsTheSquareRootOfTheAreaForEveryApex) {
  for (const Apex apex : all_apexes) {
    const Polygon p = triangle(3.7, apex, {11.25, -4.5});

    EXPECT_NEAR(std::sqrt(enclosed(p)), 3.7, 1e-13) << to_string(apex);
  }
}

TEST(TestPattern, EveryTriangleIsEquilateralWithItsCentroidWhereItWasPut) {
  const cv::Point2d place(11.25, -4.5);
  for (const Apex apex : all_apexes) {
    const Polygon p = triangle(2, apex, place);

    ASSERT_EQ(p.size(), 3U);
    // Corner coordinates near 11 carry rounding of 2e-15.
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(cv::norm(p[i] - p[(i + 1) % 3]), 2 * triangle_side, 1e-14);
    EXPECT_NEAR(cv::norm((p[0] + p[1] + p[2]) / 3 - place), 0, 1e-14);
  }
}

TEST(TestPattern, TheApexPointsWhereItsNameSays) {
  const cv::Point2d directions[] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};  // up, right, down, left with y down
  for (const Apex apex : all_apexes) {
    const Polygon p = triangle(1, apex);
    const cv::Point2d direction = directions[static_cast<int>(apex)];
    int beyond_base = 0;

    for (const cv::Point2d& corner : p) {
      const double along = corner.dot(direction);
      if (along > 0) {
        EXPECT_NEAR(along, triangle_centroid_to_apex, 1e-15);
      } else {
        EXPECT_NEAR(along, -triangle_centroid_to_base, 1e-15);
        ++beyond_base;
      }
    }

    EXPECT_EQ(beyond_base, 2);
  }
}

TEST(TestPattern, AlternativesAreTheFourApexesInTheirOrder) {
  const Alternatives shapes = triangle_alternatives();

  ASSERT_EQ(shapes.size(), all_apexes.size());
  for (const Apex apex : all_apexes) EXPECT_EQ(shapes[static_cast<std::size_t>(apex)], triangle(1, apex));
}

TEST(TestPattern, NamesOfApexesAreReadBackAndOthersRefused) {
  for (const Apex apex : all_apexes) EXPECT_EQ(apex_from(to_string(apex)), apex);
  EXPECT_FALSE(apex_from("Up").has_value());
  EXPECT_FALSE(apex_from("").has_value());
}

}  // namespace
}  // namespace todbench
