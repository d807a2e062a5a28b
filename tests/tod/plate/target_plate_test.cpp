// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/plate/target_plate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace todbench {
namespace {

using ::testing::HasSubstr;

TargetPlate small_plate() {
  TargetPlate plate;
  plate.name = "small";
  plate.width_mm = 100;
  plate.height_mm = 60;
  plate.triangles = {{"a", {-20, 5}, 10, Apex::up}, {"b", {15, -10}, 6, Apex::left}, {"c", {0, 0}, 4, Apex::right}};
  return plate;
}

void expect_same(const TargetPlate& a, const TargetPlate& b) {
  ASSERT_EQ(a.triangles.size(), b.triangles.size());
  for (std::size_t i = 0; i < a.triangles.size(); ++i) {
    EXPECT_EQ(a.triangles[i].name, b.triangles[i].name);
    EXPECT_EQ(a.triangles[i].position_mm, b.triangles[i].position_mm);
    EXPECT_EQ(a.triangles[i].size_mm, b.triangles[i].size_mm);
    EXPECT_EQ(a.triangles[i].apex, b.triangles[i].apex);
  }
  EXPECT_EQ(a.mounting, b.mounting);
}

/// The refusal of a plate, which must be invalid_input and name the plate.
std::string refusal(const TargetPlate& plate) {
  const auto result = validate(plate);
  if (result) return "accepted";
  EXPECT_EQ(result.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(result.error().message, HasSubstr("small"));
  return result.error().message;
}

TEST(TargetPlate, MirroringHorizontallySwapsLeftAndRightInPlaceAndLabel) {
  const TargetPlate seen = mounted(small_plate(), Mounting::mirrored_horizontally);

  EXPECT_EQ(seen.triangles[0].position_mm, cv::Point2d(20, 5));
  EXPECT_EQ(seen.triangles[0].apex, Apex::up);
  EXPECT_EQ(seen.triangles[1].position_mm, cv::Point2d(-15, -10));
  EXPECT_EQ(seen.triangles[1].apex, Apex::right);
}

TEST(TargetPlate, MirroringVerticallySwapsUpAndDownInPlaceAndLabel) {
  const TargetPlate seen = mounted(small_plate(), Mounting::mirrored_vertically);

  EXPECT_EQ(seen.triangles[0].position_mm, cv::Point2d(-20, -5));
  EXPECT_EQ(seen.triangles[0].apex, Apex::down);
  EXPECT_EQ(seen.triangles[1].apex, Apex::left);
}

TEST(TargetPlate, EveryMountingMovesTheOutlineOfATriangleWithItsPlace) {
  const PlateTriangle t = small_plate().triangles[1];
  for (const Mounting mounting : all_mountings) {
    const double sx = mounting == Mounting::rotated_180 || mounting == Mounting::mirrored_horizontally ? -1 : 1;
    const double sy = mounting == Mounting::rotated_180 || mounting == Mounting::mirrored_vertically ? -1 : 1;
    const PlateTriangle seen = mounted(small_plate(), mounting).triangles[1];

    const Polygon labelled = triangle(seen.size_mm, seen.apex, seen.position_mm);

    // Each corner of the cut-out, carried with the metal, is a corner of the triangle that the label describes.
    for (const cv::Point2d& corner : triangle(t.size_mm, t.apex, t.position_mm)) {
      const cv::Point2d carried(sx * corner.x, sy * corner.y);
      double nearest = std::numeric_limits<double>::infinity();
      for (const cv::Point2d& c : labelled) nearest = std::min(nearest, cv::norm(c - carried));
      EXPECT_LT(nearest, 1e-13) << to_string(mounting);
    }
  }
}

TEST(TargetPlate, EveryMountingIsItsOwnInverse) {
  for (const Mounting mounting : all_mountings) {
    expect_same(mounted(mounted(small_plate(), mounting), mounting), small_plate());
  }
}

TEST(TargetPlate, MountingsFormAGroupWhichCommutes) {
  for (const Mounting a : all_mountings) {
    for (const Mounting b : all_mountings) {
      expect_same(mounted(mounted(small_plate(), a), b), mounted(small_plate(), combined(a, b)));
      EXPECT_EQ(combined(a, b), combined(b, a));
    }
  }
  EXPECT_EQ(combined(Mounting::mirrored_horizontally, Mounting::mirrored_vertically), Mounting::rotated_180);
}

TEST(TargetPlate, NamesOfMountingsAreReadBackAndOthersRefused) {
  for (const Mounting mounting : all_mountings) EXPECT_EQ(mounting_from(to_string(mounting)), mounting);
  EXPECT_FALSE(mounting_from("rotated_90").has_value());
}

TEST(TargetPlate, AProperPlateIsAcceptedInEveryMounting) {
  for (const Mounting mounting : all_mountings) EXPECT_EQ(refusal(mounted(small_plate(), mounting)), "accepted");
}

TEST(TargetPlate, AnEmptyPlateIsRefused) {
  TargetPlate plate = small_plate();
  plate.triangles.clear();

  EXPECT_THAT(refusal(plate), HasSubstr("no triangles"));
}

TEST(TargetPlate, AnOutlineThatIsNotPositiveIsRefused) {
  TargetPlate plate = small_plate();
  plate.width_mm = 0;

  EXPECT_THAT(refusal(plate), HasSubstr("width_mm"));
}

TEST(TargetPlate, ASizeThatIsNotPositiveAndFiniteIsRefusedByName) {
  for (const double size :
       {0.0, -3.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    TargetPlate plate = small_plate();
    plate.triangles[1].size_mm = size;

    EXPECT_THAT(refusal(plate), HasSubstr("b: size_mm must be positive"));
  }
}

TEST(TargetPlate, ARepeatedNameIsRefused) {
  TargetPlate plate = small_plate();
  plate.triangles[2].name = plate.triangles[0].name;

  EXPECT_THAT(refusal(plate), HasSubstr("two cut-outs have the name \"a\""));
}

TEST(TargetPlate, ATriangleMayReachTheEdgeOfThePlateButNotLeaveIt) {
  TargetPlate plate = small_plate();
  plate.triangles[0].position_mm.y = -30 + 10 * triangle_centroid_to_apex + 1e-9;
  EXPECT_EQ(refusal(plate), "accepted");

  plate.triangles[0].position_mm.y -= 2e-9;

  EXPECT_THAT(refusal(plate), HasSubstr("a at"));
}

TEST(TargetPlate, TrianglesThatTouchAreRefusedAndNestedOnesToo) {
  TargetPlate plate = small_plate();
  // Side by side, both upright: the bases touch when the centres are one side apart.
  plate.triangles = {{"a", {-10, 0}, 10, Apex::up}, {"b", {-10 + 10 * triangle_side + 1e-9, 0}, 10, Apex::up}};
  EXPECT_EQ(refusal(plate), "accepted");

  plate.triangles[1].position_mm.x -= 2e-9;
  EXPECT_THAT(refusal(plate), HasSubstr("b touches a"));

  plate.triangles[1].position_mm = {-10, 0};
  plate.triangles[1].size_mm = 2;
  EXPECT_THAT(refusal(plate), HasSubstr("b touches a"));
}

TEST(TargetPlate, RectanglesAreCutOutsThatAreMountedLikeTriangles) {
  TargetPlate plate = small_plate();
  plate.triangles.clear();
  plate.rectangles = {{"square", {10, -4}, {12, 12}, 5}};
  EXPECT_EQ(refusal(plate), "accepted");
  const Polygon outline = outline_mm(plate.rectangles[0]);
  EXPECT_NEAR(area(outline), 144, 1e-9);
  EXPECT_NEAR(cv::norm(centroid(outline) - cv::Point2d(10, -4)), 0, 1e-9);

  const PlateRectangle turned = mounted(plate, Mounting::rotated_180).rectangles[0];
  const PlateRectangle mirrored = mounted(plate, Mounting::mirrored_horizontally).rectangles[0];

  EXPECT_EQ(turned.position_mm, cv::Point2d(-10, 4));
  EXPECT_EQ(turned.angle_deg, 5);
  EXPECT_EQ(mirrored.position_mm, cv::Point2d(-10, -4));
  EXPECT_EQ(mirrored.angle_deg, -5);
  // Every corner of the mirrored outline is the mirror image of one of the outline.
  for (const cv::Point2d& corner : outline_mm(mirrored)) {
    double nearest = 1e9;
    for (const cv::Point2d& p : outline) nearest = std::min(nearest, cv::norm(corner - cv::Point2d(-p.x, p.y)));
    EXPECT_LT(nearest, 1e-9);
  }
  plate.rectangles.push_back({"beside", {21.5, -4}, {12, 12}, 0});
  EXPECT_THAT(refusal(plate), HasSubstr("beside touches square"));
  plate.rectangles[1].size_mm.width = 0;
  EXPECT_THAT(refusal(plate), HasSubstr("beside: width_mm"));
}

}  // namespace
}  // namespace todbench
