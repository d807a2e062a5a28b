// SPDX-License-Identifier: GPL-3.0-or-later
// IFOV and distortion from the triangles of a plate, against lenses whose truth is known.
#include "tod/camera_measures/plate_geometry.h"

#include <cmath>

#include "tests/tod/measures/geometry_coverage.h"

namespace todbench {
namespace {

using testing::LensCase;

TEST(PlateGeometry, HoldsScaleRotationAndDistortion) {
#ifdef TODBENCH_SANITIZED
  constexpr int pictures = 4;  // 0.8 s each
#else
  constexpr int pictures = 16;
#endif
  const TargetPlate plate = testing::shipped_plate("tcat-a");
  for (const LensCase& lens : {LensCase{.distortion = -0.02}, LensCase{.distortion = 0.05, .noise_k = 0.1}}) {
    const auto found = testing::geometry_coverage(plate, lens, pictures);
    EXPECT_EQ(found.refused, 0);
    double within = 0;
    for (const double share : found.within) within += share / static_cast<double>(found.within.size());
    // Four intervals of a picture: as if they were one.
    EXPECT_GT(within, 0.95 - 3 * std::sqrt(0.95 * 0.05 / pictures)) << lens.distortion;
    // Distortion is not taken for a scale: 5 % at the corner is 0.3 % where the outer triangles are.
    EXPECT_LT(std::abs(found.mean_error[0]), 0.002);
    EXPECT_LT(std::abs(found.mean_error[3]), 0.3);
  }
}

TEST(PlateGeometry, TellsTheMapOfItsResiduals) {
  const TargetPlate plate = testing::shipped_plate("tcat-a");
  const auto seen = testing::lens_picture(plate, {.distortion = 0.03}, 7);

  const auto found = testing::geometry_of(plate, seen);

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_GE(found->places.size(), 12u);
  EXPECT_LT(found->residual_px, 0.05);
  EXPECT_NEAR(found->corner_px, 200, 1e-9);
  EXPECT_LT(found->farthest_px, found->corner_px);
  EXPECT_GT(found->distortion_percent.low, 0);
  for (const GeometryPlace& place : found->places) EXPECT_LT(cv::norm(place.residual_px), 0.1) << place.triangle;
}

TEST(PlateGeometry, LeavesOutATriangleThatDirtPullsAside) {
  const TargetPlate plate = testing::shipped_plate("tcat-a");
  auto seen = testing::lens_picture(plate, {}, 3);
  const auto clean = testing::geometry_of(plate, seen);
  ASSERT_TRUE(clean);
  const cv::Point2d at = clean->places[1].found_px;
  seen.picture(cv::Rect(static_cast<int>(at.x) + 2, static_cast<int>(at.y) - 1, 2, 2)) += 3.0;

  const auto found = testing::geometry_of(plate, seen);

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->places.size() + 1, clean->places.size());
  EXPECT_NEAR(found->mm_per_px_x.value, seen.truth[0], 0.004);
}

TEST(PlateGeometry, RefusesTooFewTriangles) {
  TargetPlate plate = testing::shipped_plate("tcat-a");
  const auto seen = testing::lens_picture(plate, {}, 5);
  RegistrationOptions options;
  options.expected_scale_px_per_mm = seen.spec.scale;
  const auto where = register_plate(seen.picture, plate, options);
  ASSERT_TRUE(where);
  const auto at_noise = testing::lens_picture(plate, {.noise_k = 4}, 5);
  const auto nothing = plate_geometry(at_noise.picture, plate, *where);
  plate.triangles.resize(8);
  const auto few = plate_geometry(seen.picture, plate, *where);
  // All of them on one line: no scale across it.
  TargetPlate line = testing::shipped_plate("tcat-a");
  for (PlateTriangle& t : line.triangles) t.position_mm.y = -112;

  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().code, ErrorCode::calibration);
  ASSERT_FALSE(few);
  EXPECT_EQ(few.error().code, ErrorCode::calibration);
  EXPECT_FALSE(plate_geometry(seen.picture, line, *where));
  EXPECT_FALSE(plate_geometry(cv::Mat1d(240, 320, 300.0), testing::shipped_plate("tcat-a"), *where));
}

}  // namespace
}  // namespace todbench
