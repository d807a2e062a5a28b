// SPDX-License-Identifier: GPL-3.0-or-later
// Test pictures: areas are exact and the truth is what was drawn.
#include "tod/pattern/test_picture.h"

#include <gtest/gtest.h>

#include <algorithm>

#include <cmath>
#include <numbers>

#include "hvs/shape/polygon_coverage.h"

namespace todbench {
namespace {

/// Share of a pixel by cutting the polygon at its four sides (Sutherland and Hodgman): an independent method.
double clipped_share(Polygon polygon, int column, int row) {
  for (int side = 0; side < 4; ++side) {
    const auto inside = [&](const cv::Point2d& p) {
      const double depth[4] = {p.x - column, column + 1 - p.x, p.y - row, row + 1 - p.y};
      return depth[side];
    };
    Polygon cut;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const auto& a = polygon[i];
      const auto& b = polygon[(i + 1) % polygon.size()];
      const double da = inside(a), db = inside(b);
      if (da >= 0) cut.push_back(a);
      if ((da >= 0) != (db >= 0)) cut.push_back(a + (b - a) * (da / (da - db)));
    }
    polygon = cut;
    if (polygon.size() < 3) return 0;
  }
  return area(polygon);
}

TEST(PixelCoverage, IsTheAreaOfThePolygonWithinEachPixel) {
  for (const Apex apex : all_apexes) {
    const Polygon shape = triangle(4.3, apex, {5.37, 4.81});

    const cv::Mat1d shares = pixel_coverage(shape, {11, 10});

    for (int j = 0; j < shares.rows; ++j) {
      for (int i = 0; i < shares.cols; ++i) EXPECT_NEAR(shares(j, i), clipped_share(shape, i, j), 1e-12);
    }
    EXPECT_NEAR(cv::sum(shares)[0], 4.3 * 4.3, 1e-11);
  }
}

TEST(PixelCoverage, OfAPolygonThatLeavesThePictureIsThatOfItsPartInside) {
  const Polygon shape{{-3.2, -1.1}, {9.7, 2.4}, {4.1, 12.9}, {-6, 7}};

  const cv::Mat1d shares = pixel_coverage(shape, {6, 7});

  for (int j = 0; j < shares.rows; ++j) {
    for (int i = 0; i < shares.cols; ++i) EXPECT_NEAR(shares(j, i), clipped_share(shape, i, j), 1e-12);
  }
}

TEST(TodPicture, HasTheAreaOfItsTrianglesAndEveryOrientationOnceARow) {
  const auto picture = drawn_picture({.size = {640, 480}, .kind = TodPicture{}});

  ASSERT_TRUE(picture) << picture.error().message;
  double drawn = 0;
  for (std::size_t row = 0; row < picture->plate.triangles.size(); row += 4) {
    std::vector<Apex> apexes;
    for (std::size_t i = row; i < row + 4; ++i) {
      apexes.push_back(picture->plate.triangles[i].apex);
      drawn += std::pow(picture->plate.triangles[i].size_mm, 2);
    }
    EXPECT_TRUE(std::is_permutation(apexes.begin(), apexes.end(), all_apexes.begin()));
  }
  EXPECT_GE(picture->plate.triangles.size(), 20u);
  EXPECT_NEAR(cv::sum(picture->levels)[0] / drawn, 1, 1e-12);
  EXPECT_TRUE(validate(picture->plate));
}

TEST(TodPicture, LevelsAndSeedAreWhatWasAsked) {
  const PictureRequest request{.size = {200, 200}, .low = 0.2, .high = 0.1, .kind = TodPicture{{12, 6}, 3}};
  const auto picture = drawn_picture(request), again = drawn_picture(request);

  ASSERT_TRUE(picture && again);
  EXPECT_EQ(picture->levels(0, 0), 0.2);
  EXPECT_NEAR(0.2 * 40000 - cv::sum(picture->levels)[0], 0.1 * 4 * (144 + 36), 4e-8)
      << "a sum of 40000 levels near 8000, each rounded by 1e-12";
  EXPECT_EQ(cv::norm(picture->levels, again->levels), 0);
}

TEST(MrtdPicture, HasFourBarsOfSevenToOneAndThreeEqualSpaces) {
  const auto picture = drawn_picture({.size = {200, 100}, .kind = MrtdPicture{{0.05}}});

  ASSERT_TRUE(picture) << picture.error().message;
  ASSERT_EQ(picture->bars.size(), 2u);
  // Two groups of four bars of 10 x 70 pixels.
  EXPECT_NEAR(cv::sum(picture->levels)[0], 2 * 4 * 10 * 70, 1e-9);
}

TEST(EdgePicture, HalvesThePictureAtEveryAngle) {
  for (const double angle : {-90.0, 0.0, 5.0, 37.0, 170.0}) {
    const auto picture = drawn_picture({.size = {64, 64}, .kind = EdgePicture{angle}});
    ASSERT_TRUE(picture);
    EXPECT_NEAR(cv::sum(picture->levels)[0], 2048, 1e-8) << angle;
  }
  EXPECT_EQ(drawn_picture({.size = {64, 64}, .kind = EdgePicture{0}})->levels(10, 40), 1);
}

TEST(OtherPictures, HaveTheirMeans) {
  const auto ramp = drawn_picture({.size = {100, 2}, .low = 0.2, .high = 0.6, .kind = RampPicture{}});
  EXPECT_NEAR(cv::mean(ramp->levels)[0], 0.4, 1e-14);
  const auto star = drawn_picture({.size = {101, 101}, .kind = SiemensPicture{8}});
  // Eight triangles of two radii and the angle pi / 8.
  EXPECT_NEAR(cv::sum(star->levels)[0], 8 * 0.5 * 50.5 * 50.5 * std::sin(std::numbers::pi / 8), 1e-8);
  EXPECT_EQ(cv::mean(drawn_picture({.size = {7, 5}, .kind = FlatPicture{0.25}})->levels)[0], 0.25);
}

TEST(SiemensPicture, IsDrawnUpToTheSpokesThatAreHalfACyclePerPixelAtItsBorder) {
  // 50 pi is 157.08.
  EXPECT_TRUE(drawn_picture({.size = {100, 100}, .kind = SiemensPicture{157}}));
  EXPECT_FALSE(drawn_picture({.size = {100, 100}, .kind = SiemensPicture{158}}));
  EXPECT_NEAR(finest_radius_px({.spokes = 157}), 49.975, 0.001);
}

TEST(Pictures, ThatCannotBeAreRefusedInASentence) {
  for (const PictureRequest& request : {PictureRequest{.size = {0, 5}, .kind = RampPicture{}},
                                        PictureRequest{.size = {100000, 5}, .kind = RampPicture{}},
                                        PictureRequest{.size = {5, 5}, .kind = TodPicture{}},
                                        PictureRequest{.size = {64, 64}, .kind = TodPicture{{50}, 1}},
                                        PictureRequest{.size = {64, 64}, .kind = MrtdPicture{{0.01}}},
                                        PictureRequest{.size = {64, 64}, .kind = MrtdPicture{{-1}}},
                                        PictureRequest{.size = {64, 64}, .low = -1, .kind = RampPicture{}},
                                        PictureRequest{.size = {64, 64}, .kind = FlatPicture{2}},
                                        PictureRequest{.size = {64, 64}, .kind = EdgePicture{NAN}},
                                        PictureRequest{.size = {64, 64}, .kind = SiemensPicture{1}},
                                        // Nothing of the pattern can be seen: beyond Nyquist, or without contrast.
                                        PictureRequest{.size = {640, 480}, .kind = MrtdPicture{{0.1, 0.9}}},
                                        PictureRequest{.size = {100, 100}, .kind = SiemensPicture{1000}},
                                        PictureRequest{.size = {64, 64}, .low = 1, .high = 1, .kind = EdgePicture{}},
                                        PictureRequest{.size = {64, 64}, .low = 0, .high = 0, .kind = RampPicture{}}}) {
    const auto picture = drawn_picture(request);
    ASSERT_FALSE(picture.has_value());
    EXPECT_EQ(picture.error().code, ErrorCode::invalid_input);
  }
}

}  // namespace
}  // namespace todbench
