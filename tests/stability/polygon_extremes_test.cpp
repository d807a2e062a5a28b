// SPDX-License-Identifier: GPL-3.0-or-later
// Spectra and images of shapes that meet the singular cases of the closed form, against 50-digit arithmetic.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hvs/shape/polygon_image.h"
#include "tests/stability/spectrum_50.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

using testing::Digits;
using testing::spectrum_50;

double error_of(const Polygon& polygon, double u, double w) {
  const auto found = polygon_spectrum(polygon, u, w);
  const auto exact = spectrum_50(polygon, u, w);
  return std::hypot(static_cast<double>(Digits(found.real()) - exact.re),
                    static_cast<double>(Digits(found.imag()) - exact.im));
}

// Hard: 0/0 in every form of the sum that divides by k.d: waves perpendicular to an edge, to both axes, and a hair
// beside. Angles are rounded to 1e-16 of themselves: the error is 1e-15 of the area times one plus the number of turns.
TEST(PolygonExtremes, SpectraAreRightForWavesPerpendicularToEdgesAndBesideThem) {
  for (const Apex apex : all_apexes) {
    const Polygon shape = triangle(1.7, apex, {0.3, -0.4});
    for (std::size_t i = 0; i < shape.size(); ++i) {
      const cv::Point2d d = shape[(i + 1) % shape.size()] - shape[i];
      const double length = std::hypot(d.x, d.y);
      for (const double frequency : {1e-12, 1e-8, 1e-4, 0.3, 5.0, 40.0}) {
        for (const double beside : {0.0, 1e-16, 1e-12, 1e-8, 1e-5, 1e-3}) {
          const double u = frequency * (-d.y + beside * d.x) / length, w = frequency * (d.x + beside * d.y) / length;
          EXPECT_LE(error_of(shape, u, w), 4e-15 * area(shape) * (1 + 4 * frequency)) << u << " " << w;
        }
      }
    }
  }
}

// Hard: edges parallel to the axes make whole rows and columns of the lattice perpendicular to an edge.
TEST(PolygonExtremes, LatticesAreRightAlongTheAxesForEdgesParallelToThem) {
  const Polygon square{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
  const FrequencyLattice lattice{.period = 16, .band = 64};

  const auto table = polygon_spectrum(square, lattice);

  const auto sinc = [](double x) { return x == 0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x); };
  for (int n = -lattice.band; n <= lattice.band; ++n) {
    for (int m = 0; m <= lattice.band; ++m) {
      const double exact = sinc(m / 16.0) * sinc(n / 16.0);
      EXPECT_NEAR(table(n + lattice.band, m).real(), exact, 1e-13) << m << " " << n;
      EXPECT_NEAR(table(n + lattice.band, m).imag(), 0, 1e-13) << m << " " << n;
    }
  }
}

// Hard: from 0.01 to 500 pitches the sum spans nine decades of area and two thousand turns.
TEST(PolygonExtremes, SpectraAreRightFromAHundredthOfAPitchToFiveHundred) {
  for (const double size : {0.01, 0.1, 1.0, 10.0, 100.0, 500.0}) {
    const Polygon shape = triangle(size, Apex::right, {0.123, -0.456});
    for (const double u : {0.0, 1e-9, 0.003, 0.4, 3.7}) {
      for (const double w : {0.0, -1e-7, 0.02, 1.1}) {
        const double turns = size * (u + w), off_centre = 1 + 0.5 / size;
        // Vertices are stated from the origin, half a pitch away: of a small shape they lose that many sizes.
        EXPECT_LE(error_of(shape, u, w),
                  4e-15 * area(shape) * off_centre * (1 + 4 * std::abs(turns) + 4 * (u + std::abs(w))))
            << size << " " << u << " " << w;
      }
    }
  }
}

// Hard: a centroid on a sample or exactly between two puts edges on samples and waves in phase. The triangle is
// symmetric about its own axis, so is its picture, and moving it by a whole sample moves the picture.
TEST(PolygonExtremes, PicturesAreSymmetricForCentroidsOnAndBetweenSamples) {
  const FilterTable filter({.period = 24, .band = 72}, [](double u, double w) {
    return std::exp(-2 * std::numbers::pi * std::numbers::pi * 0.16 * (u * u + w * w));
  });
  for (const double x : {0.0, 0.5, -0.5}) {
    const PolygonImage image(triangle(2.3, Apex::up, {x, 0}), filter);
    const PolygonImage moved(triangle(2.3, Apex::up, {x + 1, 0}), filter);

    const cv::Mat1d values = image.sample({x - 5, -5}, 0.5, {21, 21});
    const cv::Mat1d shifted = moved.sample({x - 4, -5}, 0.5, {21, 21});

    for (int j = 0; j < 21; ++j) {
      for (int i = 0; i < 21; ++i) {
        // A sum of 1e4 terms of at most 1e-2: rounding 1e-16 of each.
        EXPECT_NEAR(values(j, i), values(j, 20 - i), 1e-13);
        EXPECT_NEAR(values(j, i), shifted(j, i), 1e-13);
      }
    }
  }
}

}  // namespace
}  // namespace todbench
