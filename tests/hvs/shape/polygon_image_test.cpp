// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/shape/polygon_image.h"

#include <gmock/gmock.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "hvs/shape/gauss_legendre.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

/// Fourier integral over a triangle by a tensor Gauss rule: an independent second method.
std::complex<double> by_quadrature(const Polygon& t, double u, double w) {
  const auto rule = gauss_legendre(40);
  const double doubled = std::abs((t[1] - t[0]).cross(t[2] - t[0]));
  std::complex<double> sum = 0;
  for (const auto& [x, wx] : rule) {
    for (const auto& [y, wy] : rule) {
      // Duffy's map of the unit square onto the triangle.
      const double a = (1 + x) / 2;
      const double b = (1 + y) / 2 * a;
      const cv::Point2d p = t[0] + (t[1] - t[0]) * a + (t[2] - t[1]) * b;
      const double angle = -2 * std::numbers::pi * (u * p.x + w * p.y);
      sum += wx * wy / 4 * a * doubled * std::complex<double>(std::cos(angle), std::sin(angle));
    }
  }
  return sum;
}

TEST(PolygonSpectrum, AgreesWithQuadratureOfTheFourierIntegral) {
  const Polygon shape = triangle(1.7, Apex::right, {0.3, -0.4});

  for (const double u : {0.0, 1e-9, 1e-4, 0.02, 0.37, 1.5}) {
    for (const double w : {0.0, -1e-7, 0.05, -0.8, 2.1}) {
      const auto exact = polygon_spectrum(shape, u, w);

      EXPECT_NEAR(std::abs(exact - by_quadrature(shape, u, w)), 0, 2e-14 * area(shape)) << u << " " << w;
    }
  }
}

TEST(PolygonSpectrum, IsFiniteAndContinuousForWaveVectorsPerpendicularToAnEdge) {
  const Polygon shape = triangle(2.0, Apex::up);
  // The base is horizontal: waves along y are perpendicular to it, 0/0 in the quotient of the textbook formula.
  for (const double w : {0.25, 1.0, 4.0}) {
    const auto at = polygon_spectrum(shape, 0.0, w);

    const auto beside = polygon_spectrum(shape, 1e-9, w);

    EXPECT_NEAR(std::abs(at - beside), 0, 1e-7);
    EXPECT_NEAR(std::abs(at - by_quadrature(shape, 0, w)), 0, 1e-13);
  }
}

TEST(PolygonSpectrum, DoesNotDependOnTheSenseOfRotation) {
  const Polygon shape = triangle(1.3, Apex::left, {1, 2});
  const Polygon reversed(shape.rbegin(), shape.rend());

  EXPECT_NEAR(std::abs(polygon_spectrum(shape, 0.3, 0.7) - polygon_spectrum(reversed, 0.3, 0.7)), 0, 1e-15);
}

TEST(PolygonSpectrum, KeepsItsRelativeAccuracyFromTinyToHugeShapes) {
  for (const double size : {0.01, 1.0, 500.0}) {
    const Polygon shape = triangle(size, Apex::down);
    // Scaling: F of a shape s times as large at frequency u / s is s^2 times F.
    const Polygon unit = triangle(1, Apex::down);
    for (const double u : {1e-6, 1e-3, 0.11, 0.9}) {
      const auto scaled = polygon_spectrum(shape, u / size, 0.4 / size);

      EXPECT_NEAR(std::abs(scaled / (size * size) - polygon_spectrum(unit, u, 0.4)), 0, 1e-14) << size << " " << u;
    }
  }
}

TEST(PolygonSpectrum, TableEqualsTheSingleFrequencyForm) {
  for (const Apex apex : all_apexes) {
    const Polygon shape = triangle(1.6, apex, {0.25, -0.125});
    const FrequencyLattice lattice{.period = 24, .band = 60};

    const auto table = polygon_spectrum(shape, lattice);

    double largest = 0;
    for (int r = 0; r < table.rows; ++r) {
      for (int m = 0; m < table.cols; ++m) {
        const auto exact = polygon_spectrum(shape, m / 24.0, (r - lattice.band) / 24.0);
        largest = std::max(largest, std::abs(table(r, m) - exact));
      }
    }
    EXPECT_LT(largest, 1e-13 * area(shape)) << to_string(apex);
  }
}

/// A Gaussian blur wide enough to be band-limited on the test lattice.
TransferFunction gaussian(double sigma) {
  return [sigma](double u, double w) { return std::exp(-2 * std::pow(std::numbers::pi * sigma, 2) * (u * u + w * w)); };
}

TEST(PolygonImage, OfASquareBlurredByAGaussianIsAProductOfErrorFunctions) {
  const double sigma = 0.4;
  const Polygon square{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  const FilterTable filter({.period = 16, .band = 60}, gaussian(sigma));

  const PolygonImage image(square, filter);

  const cv::Mat1d values = image.sample({-2.3, 0.45}, 0.5, {9, 3});
  const auto edge = [sigma](double x) {
    return (std::erf((1 - x) / sigma / std::numbers::sqrt2) + std::erf((1 + x) / sigma / std::numbers::sqrt2)) / 2;
  };
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 9; ++i) EXPECT_NEAR(values(j, i), edge(-2.3 + 0.5 * i) * edge(0.45 + 0.5 * j), 1e-12);
  }
}

/// Triangles of which half a spectrum is kept, each way up, and one beside the origin, of which all is.
std::vector<Polygon> shapes(double size) {
  std::vector<Polygon> out{triangle(size, Apex::right, {0.1, 0.2})};
  for (const Apex apex : all_apexes) out.push_back(triangle(size, apex));
  return out;
}

TEST(PolygonImage, FineImageHoldsEveryPhaseThatSampleComputesSingly) {
  const FilterTable filter({.period = 16, .band = 60}, gaussian(0.35));
  for (const Polygon& shape : shapes(1.6)) {
    const PolygonImage image(shape, filter);

    const cv::Mat1d fine = image.fine_image(16);
    const cv::Mat1d values = image.sample({-3 + 5 / 16.0, -2 + 11 / 16.0}, 1, {7, 5});

    for (int j = 0; j < 5; ++j) {
      for (int i = 0; i < 7; ++i) {
        const int y = (((-2 + j) * 16 + 11) + 256) % 256;
        const int x = (((-3 + i) * 16 + 5) + 256) % 256;
        EXPECT_NEAR(values(j, i), fine(y, x), 1e-14);
      }
    }
  }
}

TEST(PolygonImage, FineImageNearTheOriginIsThatOfTheWholePeriod) {
  const FilterTable filter({.period = 20, .band = 75}, gaussian(0.35));
  for (const Polygon& shape : shapes(2.6)) {
    const PolygonImage image(shape, filter);
    const cv::Mat1d whole = image.fine_image(16);
    for (const int reach : {3, 9, 10, 40}) {
      const cv::Mat1d near = image.fine_image(16, reach);
      const int points = std::min(160, 16 * reach);
      for (int y = -points; y < points; ++y) {
        const int row = (y + 320) % 320;
        for (int x = -points; x < points; ++x) {
          const int column = (x + 320) % 320;
          ASSERT_EQ(near(row, column), whole(row, column)) << reach;
        }
      }
    }
  }
}

TEST(PolygonImage, OfHalfASpectrumIsThatOfTheWholeOne) {
  const FrequencyLattice lattice{.period = 24, .band = 90};
  const FilterTable even(lattice, gaussian(0.25));
  // So little that no sum sees it, and no longer equal at w and -w.
  const FilterTable uneven(lattice, [blur = gaussian(0.25)](double u, double w) {
    return blur(u, w) + std::complex<double>(0, std::copysign(1e-200, w));
  });
  ASSERT_TRUE(even.turns_alike());
  ASSERT_FALSE(uneven.even());
  for (const Polygon& shape : shapes(2.3)) {
    const PolygonImage image(shape, even), expected(shape, uneven);
    for (const double step : {1.0, 0.5, 24.0 / 23}) {
      const cv::Point2d first(-4.7, -3.2);
      EXPECT_LT(cv::norm(image.sample(first, step, {9, 30}), expected.sample(first, step, {9, 30}), cv::NORM_INF),
                5e-15);
    }
    for (const int per_unit : {8, 11}) {
      EXPECT_LT(cv::norm(image.fine_image(per_unit), expected.fine_image(per_unit), cv::NORM_INF), 5e-15);
    }
  }
}

TEST(PolygonImage, TurnedIsThatOfTheTurnedShape) {
  const FilterTable filter({.period = 16, .band = 60}, gaussian(0.3));
  Polygon shape{{-1.2, -0.4}, {0.9, -0.7}, {0.3, 1.1}};  // no mirror image of itself
  const PolygonImage image(shape, filter);
  for (int quarters = 0; quarters < 5; ++quarters) {
    const PolygonImage expected(shape, filter);

    EXPECT_LT(cv::norm(image.turned(quarters).sample({-3.1, -2.4}, 1, {7, 5}), expected.sample({-3.1, -2.4}, 1, {7, 5}),
                       cv::NORM_INF),
              5e-15);
    EXPECT_LT(cv::norm(image.turned(quarters).fine_image(8), expected.fine_image(8), cv::NORM_INF), 5e-15);
    for (auto& vertex : shape) vertex = {-vertex.y, vertex.x};
  }
}

TEST(PolygonImage, OfAFilterThatDiffersInXAndYIsNotTurned) {
  const TransferFunction oblong = [](double u, double w) { return std::exp(-8 * u * u - 3 * w * w); };
  const FilterTable filter({.period = 16, .band = 60}, oblong);
  EXPECT_TRUE(filter.even());
  EXPECT_FALSE(filter.turns_alike());
  // A half of the upright one is kept, all of the one that lies; swapping x and y everywhere gives the same numbers.
  const FilterTable swapped({.period = 16, .band = 60}, [&](double u, double w) { return oblong(w, u); });
  const cv::Mat1d upright = PolygonImage(triangle(2, Apex::down), filter).sample({-3.2, -2.9}, 1, {7, 6});
  const cv::Mat1d lying = PolygonImage(triangle(2, Apex::right), swapped).sample({-2.9, -3.2}, 1, {6, 7});
  EXPECT_LT(cv::norm(upright, lying.t(), cv::NORM_INF), 5e-15);
}

TEST(PolygonImage, ConservesTheAreaOfTheShape) {
  const FilterTable filter({.period = 12, .band = 40}, gaussian(0.5));
  const PolygonImage image(triangle(2, Apex::down), filter);

  const cv::Mat1d fine = image.fine_image(8);

  EXPECT_NEAR(cv::sum(fine)[0] / 64, 4, 1e-12);
}

TEST(GaussLegendre, IntegratesPolynomialsUpToTwiceItsOrderExactly) {
  for (const int n : {1, 2, 5, 16, 192}) {
    const auto rule = gauss_legendre(n);
    const int degree = std::min(2 * n - 2, 40);

    double sum = 0;
    for (const auto& [x, weight] : rule) sum += weight * std::pow(x, degree);

    EXPECT_NEAR(sum, 2.0 / (degree + 1), 1e-14) << n;
  }
}

}  // namespace
}  // namespace todbench
