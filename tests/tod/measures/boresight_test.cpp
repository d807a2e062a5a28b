// SPDX-License-Identifier: GPL-3.0-or-later
// Line of sight of cameras whose shift, roll and zoom are known.
#include "tod/camera_measures/boresight.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "tests/tod/measures/geometry_coverage.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;

constexpr double distance_m = 2;

/// A measurement of a camera that sees the plate by this lens; place and rotation follow from the seed.
GeometryMeasure measured(const TargetPlate& plate, const testing::LensPicture& seen, double mm_per_px) {
  const auto found = testing::geometry_of(plate, seen);
  EXPECT_TRUE(found) << found.error().message;
  return {.plate = plate.name,
          .distance_m = distance_m,
          .stated_ifov_mrad = mm_per_px / distance_m,
          .picture = seen.picture.size(),
          .geometry = found.value_or(PlateGeometry{})};
}

/// Place of the plate in the middle of the picture, from the mapping that made it.
cv::Point2d true_centre_mm(const testing::LensPicture& seen) {
  const cv::Matx33d back = testing::true_mapping(seen.spec).inv();
  const cv::Vec3d at = back * cv::Vec3d((seen.spec.size.width - 1) / 2.0, (seen.spec.size.height - 1) / 2.0, 1);
  return {at(0) / at(2), at(1) / at(2)};
}

bool holds(const Estimate& found, double truth) {
  return found.low <= truth && truth <= found.high;
}

TEST(Boresight, HoldsShiftAndRollBetweenZoomStatesWithDistortion) {
  const TargetPlate plate = testing::shipped_plate("tcat-a");
  constexpr double zoomed_mm_per_px = 0.9 * testing::mm_per_pixel;
  int held = 0, intervals = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const auto wide = testing::lens_picture(plate, {.distortion = -0.02}, seed);
    const auto narrow = testing::lens_picture(plate, {.distortion = 0.01, .mm_per_px = zoomed_mm_per_px}, 100 + seed);
    const cv::Point2d moved_mm = true_centre_mm(narrow) - true_centre_mm(wide);
    const double angle = wide.spec.rotation_deg * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
    const cv::Point2d shift_mm(c * moved_mm.x - s * moved_mm.y, s * moved_mm.x + c * moved_mm.y);

    const auto found =
        boresight(measured(plate, wide, testing::mm_per_pixel), measured(plate, narrow, zoomed_mm_per_px));

    ASSERT_TRUE(found) << found.error().message;
    EXPECT_NEAR(found->shift_x_mrad.value, shift_mm.x / distance_m, 0.05) << seed;
    EXPECT_NEAR(found->shift_y_mrad.value, shift_mm.y / distance_m, 0.05) << seed;
    EXPECT_NEAR(found->shift_x_px.value, shift_mm.x / testing::mm_per_pixel, 0.05) << seed;
    const double roll = 1000 * std::numbers::pi / 180 * (wide.spec.rotation_deg - narrow.spec.rotation_deg);
    EXPECT_NEAR(found->roll_mrad.value, roll, 0.5) << seed;
    EXPECT_NEAR(found->ifov_ratio, 0.9, 0.002);
    held += holds(found->shift_x_mrad, shift_mm.x / distance_m) ? 1 : 0;
    held += holds(found->shift_y_mrad, shift_mm.y / distance_m) ? 1 : 0;
    held += holds(found->roll_mrad, roll) ? 1 : 0;
    intervals += 3;
    EXPECT_LT(found->shift_x_mrad.high - found->shift_x_mrad.low, 0.2);
  }
  // 95 % of 18 with a standard deviation of 0.9.
  EXPECT_GE(held, intervals - 4);
}

TEST(Boresight, IsRefusedForSessionsThatDoNotFitTogether) {
  const TargetPlate plate = testing::shipped_plate("tcat-a");
  const GeometryMeasure a = measured(plate, testing::lens_picture(plate, {}, 3), testing::mm_per_pixel);
  GeometryMeasure b = measured(plate, testing::lens_picture(plate, {}, 4), testing::mm_per_pixel);
  const auto refusal = [&](const GeometryMeasure& other) {
    const auto found = boresight(a, other);
    return found ? std::string() : found.error().message;
  };
  GeometryMeasure plate_b = b, far = b, large = b, lying = b, old = b, beside = b;
  plate_b.plate = "tcat-b";
  far.distance_m = 2.1;
  large.picture = {640, 480};
  lying.stated_ifov_mrad *= 2;  // another zoom state than the one that was measured
  old.geometry.centre_x_mm = old.geometry.centre_y_mm = {};
  for (GeometryPlace& place : beside.geometry.places) place.found_px.x += 160;

  EXPECT_EQ(refusal(b), "");
  EXPECT_THAT(refusal(plate_b), HasSubstr("plates differ"));
  EXPECT_THAT(refusal(far), HasSubstr("distances differ"));
  EXPECT_THAT(refusal(large), HasSubstr("pictures differ"));
  EXPECT_THAT(refusal(lying), HasSubstr("ratio of the IFOV"));
  EXPECT_THAT(refusal(old), HasSubstr("again"));
  EXPECT_THAT(refusal(beside), HasSubstr("surround"));
  b.distance_relative_u = 0.01;
  const auto with_distance = boresight(a, b);
  ASSERT_TRUE(with_distance);
  const Estimate& x = with_distance->shift_x_mrad;
  EXPECT_GE(0.5 * (x.high - x.low), 0.0196 * std::abs(x.value));
}

}  // namespace
}  // namespace todbench
