// SPDX-License-Identifier: GPL-3.0-or-later
// Identification by the naked eye, and detection of compact patterns.
#include "hvs/observer/naked_eye.h"

#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

#include "hvs/eye/compact_patterns.h"
#include "hvs/eye/viewed_display.h"
#include "hvs/observer/eye_noise.h"
#include "hvs/shape/polygon_image.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

TEST(NakedEye, SeesTheTrianglesOfThePrototype) {
  // Square root of area in arcmin at 75 % correct, kappa 0.05, of a prototype in another language that draws the
  // triangles on a grid.
  const NakedEyeShape triangle(triangle_alternatives().front());
  const double contrasts[] = {0.02, 0.05, 0.1, 0.2, 0.5, 0.9};
  const struct {
    double luminance_cd_m2, arcmin[6];
  } rows[] = {{1, {32.9, 18.1, 12.5, 8.9, 5.9, 4.6}},
              {10, {19.7, 10.9, 7.6, 5.5, 3.7, 2.9}},
              {100, {12.6, 7.0, 5.0, 3.6, 2.5, 2.0}},
              {300, {10.4, 5.9, 4.2, 3.1, 2.1, 1.8}}};
  for (const auto& row : rows) {
    const EyeFilter eye({}, row.luminance_cd_m2);
    for (std::size_t i = 0; i < 6; ++i) {
      const double found = 60 * triangle.threshold_deg(eye, 0.05, contrasts[i], 0.75).value();

      // Half a unit of the last digit of the prototype, and 3.5 %, of which 1 % is its d' of 500 channels.
      EXPECT_NEAR(found, row.arcmin[i], 0.05 + 0.035 * row.arcmin[i]) << row.luminance_cd_m2 << ' ' << contrasts[i];
    }
  }
}

TEST(NakedEye, HasTheProductsOfTheNoiseOfTheEye) {
  // EyeNoise integrates the same products over a lattice of frequencies instead of a circle.
  const double size_deg = 0.1, sample_deg = 0.05;
  const EyeFilter eye({}, 50);
  const FilterTable power(FrequencyLattice{.period = 32, .band = 96}, [&](double u, double w) {
    return std::complex<double>(eye.identification_power(std::hypot(u, w) / sample_deg));
  });
  EyeTemplates templates{.steps = 1, .reach = 0, .sample_deg = sample_deg, .display = {}};
  for (const Polygon& shape : triangle_alternatives())
    templates.shapes.push_back(placed(shape, size_deg / sample_deg, {0, 0}));
  const EyeNoise noise(templates, power);

  const auto found = NakedEyeShape(triangle_alternatives().front()).products(eye, size_deg);

  // Opposite directions have one product, and so have both neighbours, whichever way the alternatives turn.
  for (std::size_t o = 0; o < 4; ++o) EXPECT_NEAR(found[o], noise.covariance(0, o), 2e-4 * found[0]) << o;
}

TEST(NakedEye, TurnsContrastIntoSizeAndBack) {
  const NakedEyeShape ring(landolt_ring());
  const EyeFilter eye({}, 100);
  const double size = ring.threshold_deg(eye, 0.03, 0.2, 0.625).value();

  EXPECT_NEAR(ring.threshold_contrast(eye, 0.03, size, 0.625).value(), 0.2, 1e-6);
  EXPECT_NEAR(ring.probability_correct(eye, 0.03, 0.2, size), 0.625, 1e-6);
  EXPECT_FALSE(ring.threshold_deg(eye, 0.03, 1e-6, 0.625));
}

TEST(NakedEye, IsRightByChanceWithoutContrast) {
  const NakedEyeShape ring(landolt_ring());

  EXPECT_NEAR(ring.probability_correct(EyeFilter({}, 100), 0, 0, 0.1), 0.25, 1e-4);
}

TEST(NakedEye, HasARingOfTheAreaOfItsStrokes) {
  // The ring between the radii 2.5 and 1.5 less the gap, whose ends are arcs.
  const auto segment = [](double radius) {
    const double angle = std::asin(0.5 / radius);
    return radius * radius * angle + 0.5 * radius * std::cos(angle);
  };
  const double exact = std::numbers::pi * (2.5 * 2.5 - 1.5 * 1.5) - (segment(2.5) - segment(1.5));

  EXPECT_NEAR(area(landolt_ring()) / exact, 1, 4e-3);
}

TEST(CompactPatterns, OfAWideFlatFilterHaveTheirEnergy) {
  // A blob so small that H is that of its centre over the whole band of the eye: d' is proportional to its area.
  const EyeFilter eye({}, 50);
  const double small = 3e-5;

  EXPECT_NEAR(blob_d_prime(eye, 2 * small) / blob_d_prime(eye, small), 4, 1e-3);
  // A disc and a blob of one volume are the same spot of light.
  EXPECT_NEAR(disc_d_prime(eye, std::numbers::sqrt2 * small) / blob_d_prime(eye, small), 1, 1e-3);
}

TEST(CompactPatterns, LineIsARowOfDiscs) {
  // A narrow line in a window: twice the width is twice the light; the dipole of a narrow stripe is its derivative.
  const EyeFilter eye({}, 30);
  const double width = 1e-4;

  EXPECT_NEAR(line_d_prime(eye, 2 * width, 0.5, LineProfile::line) / line_d_prime(eye, width, 0.5, LineProfile::line),
              2, 1e-2);
  EXPECT_NEAR(
      line_d_prime(eye, 2 * width, 0.5, LineProfile::dipole) / line_d_prime(eye, width, 0.5, LineProfile::dipole), 4,
      2e-2);
}

}  // namespace
}  // namespace todbench
