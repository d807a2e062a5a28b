// SPDX-License-Identifier: GPL-3.0-or-later
// Distortion, display and turbulence of the simulated sensor against closed forms and second ways.
#include "sim_devices/sensor/effect_turbulence.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>

#include "hvs/shape/gauss_legendre.h"
#include "sim_devices/sensor/effect_display.h"
#include "sim_devices/sensor/effect_row.h"
#include "sim_devices/sensor/image_chain.h"
#include "sim_devices/sensor/sensor_model.h"
#include "sim_devices/sensor/transfer_functions.h"
#include "tests/sim_devices/prediction/effect_grid.h"
#include "tests/sim_devices/sensor/effect_scene.h"

namespace todbench {
namespace {

using test::scene;

/// Sum of a picture and the place of its mean.
std::array<double, 3> moments(const cv::Mat1f& picture) {
  double sum = 0, x = 0, y = 0;
  for (int row = 0; row < picture.rows; ++row) {
    for (int column = 0; column < picture.cols; ++column) {
      const auto value = static_cast<double>(picture(row, column));
      sum += value, x += value * column, y += value * row;
    }
  }
  return {sum, x / sum, y / sum};
}

// A second way: points spread over the triangle, each moved by the lens and counted by the area that it becomes.
TEST(Effects, DistortionShowsATriangleWhereAndAsLargeAsTheLensDoes) {
  for (const auto& [k1, k2] : {std::pair(6.0, 0.0), std::pair(-6.0, 2.0)}) {
    SensorSpec straight = test::sc2000();
    constexpr int fine = 4;  // samples a pitch: a straight side along the rows aliases at one a pitch
    straight.microscan = fine;
    SensorSpec bent = straight;
    bent.distortion_percent = k1, bent.distortion_r4_percent = k2;
    PlateScene before = scene(1);
    const double mm_per_px = before.distance_m * straight.ifov_mrad();
    before.plate.triangles = {{.name = "far out",
                               .position_mm = {-100 * mm_per_px, 60 * mm_per_px},
                               .size_mm = 20 * mm_per_px,
                               .apex = Apex::up}};
    before.motion = {};
    before.centre_px = {0, 0};
    const auto seen = [&](const SensorSpec& spec) {
      return moments(*SensorModel(spec, full_plan(spec, {}, {}), Accuracy::normal(), 1).unit_signal(before));
    };
    const auto place = [&](cv::Point2d p) {
      const double s = p.dot(p) / 40000;  // half the diagonal of 320 x 240 is 200
      return p * (1 + 0.01 * s * (k1 + s * k2));
    };

    const auto from = seen(straight), to = seen(bent);

    const Polygon outline = triangle(20, Apex::up, {-100, 60});
    double area = 0;
    cv::Point2d middle(0, 0);
    constexpr int steps = 300;
    for (int i = 0; i < steps; ++i) {
      for (int j = 0; j < steps - i; ++j) {
        const double a = (i + 1.0 / 3) / steps, b = (j + 1.0 / 3) / steps, h = 1e-4;
        const cv::Point2d p = outline[0] + a * (outline[1] - outline[0]) + b * (outline[2] - outline[0]);
        const cv::Point2d dx = (place(p + cv::Point2d(h, 0)) - place(p - cv::Point2d(h, 0))) / (2 * h),
                          dy = (place(p + cv::Point2d(0, h)) - place(p - cv::Point2d(0, h))) / (2 * h);
        const double part = dx.cross(dy);
        area += part, middle += part * place(p);
      }
    }
    middle /= area;
    // Points stand for half of the little triangles: the same share of all, but for 1 / steps of an edge.
    EXPECT_NEAR(to[0] / from[0], area / (0.5 * steps * (steps + 1)), 1e-3) << k1;
    EXPECT_NEAR((to[1] - from[1]) / fine, middle.x + 100, 0.01) << k1;
    EXPECT_NEAR((to[2] - from[2]) / fine, middle.y - 60, 0.01) << k1;
  }
}

TEST(Effects, TheDisplayFilterHasTheStatedResponse) {
  SensorSpec spec = test::sc2000();
  spec.display = DisplayReconstruction::bilinear;
  spec.display_blur_samples = 0.3;
  const auto taps = taps_of([&](double f) { return display_response(spec, f); });
  for (const double f : {0.0, 0.1, 0.25, 0.4}) {
    double response = 0;
    for (std::size_t k = 0; k < taps.size(); ++k)
      response += taps[k] * std::cos(2 * std::numbers::pi * f * (static_cast<double>(k) - 8));
    // Cut after eight samples, where taps have fallen to the slope at the band's end over 2 pi^2 k^2: 2e-3 each.
    EXPECT_NEAR(response, display_response(spec, f), 4e-3) << f;
  }
}

TEST(Effects, TheEdgeFilterHasThreeTapsAndLeavesEvenSurfacesAlone) {
  SensorSpec spec = test::sc2000();
  spec.edge_boost = 0.4;
  const auto taps = taps_of([&](double f) { return display_response(spec, f); });
  ASSERT_EQ(taps.size(), 17U);
  for (std::size_t k = 0; k < taps.size(); ++k)
    EXPECT_NEAR(taps[k], k == 8 ? 1.8 : k == 7 || k == 9 ? -0.4 : 0, 1e-12) << k;
  // Both axes: the square of 1.8^2 + 2 0.4^2.
  EXPECT_NEAR(display_noise_gain(spec), 3.56, 1e-12);
}

/// A narrow field: 15 um behind 1 m, 0.2 m of aperture.
SensorSpec narrow_field(double cn2) {
  SensorSpec spec = test::sc2000();
  spec.pitch_um = 15;
  spec.detector_um = 14;
  spec.focal_length_mm = 1000;
  spec.f_number = 5;
  spec.turbulence_cn2_m_minus_2_3 = cn2;
  spec.turbulence_path_m = 2000;
  return spec;
}

TEST(Effects, TurbulenceMultipliesTheOpticsByFriedsLongExposure) {
  for (const double cn2 : {1e-15, 1e-14, 1e-13}) {
    const SensorSpec spec = narrow_field(cn2);
    const OpticsMtf with(spec, full_plan(spec, {}, {}), 16);
    const OpticsMtf without(spec, full_plan(spec, {Effect::turbulence}, {}), 16);
    const double wavelength_m = turbulent_path(spec)->wavelength_um * 1e-6;
    const double k = 2 * std::numbers::pi / wavelength_m;
    // Spherical wave, constant Cn2: the weight (z / L)^(5/3) has the mean 3/8 (Fried 1966).
    const double r0_m = std::pow(0.423 * k * k * cn2 * 2000 * 3 / 8, -0.6);
    for (const double per_pitch : {0.05, 0.1, 0.2}) {
      const double cycles_per_rad = per_pitch * 1000 / spec.ifov_mrad();
      EXPECT_NEAR(with(per_pitch),
                  without(per_pitch) * std::exp(-3.44 * std::pow(wavelength_m * cycles_per_rad / r0_m, 5.0 / 3)),
                  1e-12);
    }
  }
}

// A second way: phases along the aperture drawn as sums of waves of random direction whose structure function is
// 6.88 (r / r0)^(5/3), as Kolmogorov's; their mean coherence is the transfer function.
TEST(Effects, TurbulenceIsTheMeanCoherenceOfDrawnPhaseScreens) {
  const SensorSpec spec = narrow_field(2e-14);
  const double wavelength_m = turbulent_path(spec)->wavelength_um * 1e-6;
  const double r0_m = fried_spherical_m(*turbulent_path(spec));
  const OpticsMtf with(spec, full_plan(spec, {Effect::diffraction}, {}), 16);
  constexpr int screens = 2000, waves = 90;
  const std::array separations{0.02, 0.05, 0.1};
  std::array<double, 3> coherence{};
  // Structure function of a plane wave of wave number q and random direction: 2 a^2 (1 - J0(q r)); with powers
  // a^2 = g q^(-5/3) per ln q: 2 g r^(5/3) int x^(-8/3) (1 - J0(x)) dx = 2 g r^(5/3) x 1.1183.
  const double integral = std::pow(2, -5.0 / 3) * 1.2 * std::tgamma(1.0 / 6) / std::tgamma(11.0 / 6) / 2;
  const double g = 6.88 * std::pow(r0_m, -5.0 / 3) / (2 * integral);
  const double lowest = 1e-5, highest = 1e3, step = std::log(highest / lowest) / waves;  // rad/m
  for (int s = 0; s < screens; ++s) {
    const RandomStream random = RandomStream(3, "screens").sub(static_cast<std::uint64_t>(s));
    std::array<double, 3> difference{};
    for (int n = 0; n < waves; ++n) {
      const auto at = static_cast<std::uint64_t>(4 * n);
      const double q = lowest * std::exp(step * (n + random.uniform(at)));
      const double along = q * std::cos(2 * std::numbers::pi * random.uniform(at + 1));
      const double amplitude = std::sqrt(2 * g * std::pow(q, -5.0 / 3) * step);
      const double start = 2 * std::numbers::pi * random.uniform(at + 2);
      for (std::size_t i = 0; i < separations.size(); ++i)
        difference[i] += amplitude * (std::cos(start + along * separations[i]) - std::cos(start));
    }
    for (std::size_t i = 0; i < separations.size(); ++i) coherence[i] += std::cos(difference[i]) / screens;
  }
  for (std::size_t i = 0; i < separations.size(); ++i) {
    const double per_pitch = separations[i] / wavelength_m / 1000 * spec.ifov_mrad();
    // Four standard errors of a mean of cosines, at most 1 / sqrt(2 N).
    EXPECT_NEAR(coherence[i], with(per_pitch), 4 / std::sqrt(2.0 * screens)) << separations[i];
  }
}

TEST(Effects, PicturesThroughTurbulenceAreThoseOfTheInfinitePlane) {
  // Far tails: the same triangle by a lattice and by one twice as long.
  SensorSpec spec = test::sc2000();
  spec.turbulence_cn2_m_minus_2_3 = 1e-11;
  spec.turbulence_path_m = 5000;
  ASSERT_GT(turbulence_strength(spec), 0.5);
  const ImageChain chain(spec, full_plan(spec, {}, {}), Accuracy::normal());

  const auto plane = chain.infinite_plane(triangle(3, Apex::up), {-4, -4}, 1, {9, 9});

  const cv::Mat1d lattice = chain.image(triangle(3, Apex::up)).sample({-4, -4}, 1, {9, 9});
  EXPECT_LT(cv::norm(plane.values, lattice, cv::NORM_INF), Accuracy::normal().wrap_tolerance);
}

}  // namespace
}  // namespace todbench
