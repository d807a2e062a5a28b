// SPDX-License-Identifier: GPL-3.0-or-later
// Halo of the simulated sensor against the closed form of a normal blur, alone and in whole frames.
#include <gmock/gmock.h>

#include <cmath>

#include "hvs/shape/painted_shapes.h"
#include "sim_devices/sensor/image_chain.h"
#include "sim_devices/sensor/scene_image.h"
#include "tests/sim_devices/reference.h"

namespace todbench {
namespace {

SensorSpec with_halo(double share, double sigma_pitch) {
  SensorSpec spec = test::sc2000();
  spec.halo_share = share, spec.halo_sigma_pitch = sigma_pitch;
  return spec;
}

Polygon square(double side, cv::Point2d middle = {0, 0}) {
  const double h = side / 2;
  return {middle + cv::Point2d(-h, -h), middle + cv::Point2d(h, -h), middle + cv::Point2d(h, h),
          middle + cv::Point2d(-h, h)};
}

/// Normal blur of a square with its middle at the origin.
double blurred_square(double side, double sigma, cv::Point2d at) {
  const auto along = [&](double x) {
    const double root = std::sqrt(2.0) * sigma;
    return 0.5 * (std::erf((x + side / 2) / root) - std::erf((x - side / 2) / root));
  };
  return along(at.x) * along(at.y);
}

// Diffraction and the detector also blur the light of the halo: by 0.3 pitches, of 3 and more. Beside an edge, the tail
// of diffraction takes up to 1 % of it: 8e-4.
TEST(Halo, SpreadsItsShareOfTheLightInANormalBlur) {
  for (const auto& [sigma, side] : {std::pair(3.0, 2.0), {3.0, 60.0}, {50.0, 12.0}}) {
    constexpr double share = 0.08;
    const SensorSpec spec = with_halo(share, sigma), plain = test::sc2000();
    const ImageChain haze(spec, full_plan(spec, {}, {}), Accuracy::normal());
    const ImageChain sharp(plain, full_plan(plain, {}, {}), Accuracy::normal());
    const cv::Mat1d found = haze.infinite_plane(square(side), {-20, -20}, 8, {6, 6}).values;
    const cv::Mat1d core = sharp.infinite_plane(square(side), {-20, -20}, 8, {6, 6}).values;
    for (int y = 0; y < 6; ++y) {
      for (int x = 0; x < 6; ++x) {
        const double spread = blurred_square(side, std::hypot(sigma, 0.3), {8.0 * x - 20, 8.0 * y - 20});
        EXPECT_NEAR(found(y, x), (1 - share) * core(y, x) + share * spread, 8e-4) << sigma << " " << side;
      }
    }
  }
}

// Pictures of single shapes have a short period: what wraps round is within the stated tolerance.
TEST(Halo, OfASingleShapeWrapsRoundWithinTheTolerance) {
  const Accuracy accuracy = Accuracy::normal();
  for (const double sigma : {3.0, 50.0}) {
    const SensorSpec spec = with_halo(0.1, sigma);
    const ImageChain chain(spec, full_plan(spec, {}, {}), accuracy);
    for (const double side : {1.0, 6.0}) {
      const cv::Mat1d alone = chain.image(square(side)).sample({-8, -8}, 1, {17, 17});
      const cv::Mat1d plane = chain.infinite_plane(square(side), {-8, -8}, 1, {17, 17}).values;
      EXPECT_LT(cv::norm(alone, plane, cv::NORM_INF), 2 * accuracy.wrap_tolerance) << sigma << " " << side;
    }
  }
}

TEST(Halo, OfWholeFramesIsThatOfThePolygonAlone) {
  for (const double sigma : {4.0, 25.0}) {
    const SensorSpec spec = with_halo(0.1, sigma);
    const SensorPlan plan = full_plan(spec, {}, {});
    const cv::Size size(60, 50);
    // One square in the frame, one so far outside that only its halo comes in.
    const Polygon inside = square(20, {40.3, 30.1}), outside = square(30, {-30.4, 31});
    const ImageChain chain(spec, plan, Accuracy::normal());
    const cv::Mat1d exact =
        chain.infinite_plane(inside, {0, 0}, 1, size).values + chain.infinite_plane(outside, {0, 0}, 1, size).values;
    const std::vector<PaintedPolygon> painted{{inside, 1}, {outside, 1}};

    const cv::Mat1d found = SceneImager(spec, plan, Accuracy::normal()).image(visible_edges(painted), size);

    EXPECT_LT(cv::norm(exact, found, cv::NORM_INF), 2e-4) << sigma;
  }
}

TEST(Halo, WithoutAWidthIsRefused) {
  const auto valid = validate(with_halo(0.05, 0));

  ASSERT_FALSE(valid);
  EXPECT_THAT(valid.error().message, ::testing::HasSubstr("halo_sigma_pitch"));
}

}  // namespace
}  // namespace todbench
