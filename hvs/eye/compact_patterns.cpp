// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/eye/compact_patterns.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hvs/eye/eye_optics.h"

namespace todbench {
namespace {

constexpr double pi = std::numbers::pi;

/// Integral of detection_power |F|^2 over all directions and frequencies by the midpoint rule; F depends on the
/// frequency only and turns over `extent_deg`. 24 points for a turn: the error of d' is below 1e-4.
template <typename Spectrum>
double radial_d_prime(const EyeFilter& eye, double extent_deg, Spectrum spectrum) {
  const double limit = diffraction_limit_per_degree(eye.pupil_mm());
  const int points = std::max(4000, static_cast<int>(24 * limit * extent_deg));
  const double step = limit / points;
  double sum = 0;
  for (int i = 0; i < points; ++i) {
    const double f = step * (i + 0.5);
    sum += 2 * pi * f * eye.detection_power(f) * std::pow(spectrum(f), 2);
  }
  return std::sqrt(sum * step);
}

}  // namespace

double blob_d_prime(const EyeFilter& eye, double sigma_deg) {
  return radial_d_prime(eye, sigma_deg, [&](double f) {
    return 2 * pi * sigma_deg * sigma_deg * std::exp(-2 * std::pow(pi * sigma_deg * f, 2));
  });
}

double disc_d_prime(const EyeFilter& eye, double radius_deg) {
  return radial_d_prime(eye, radius_deg,
                        [&](double f) { return radius_deg * std::cyl_bessel_j(1.0, 2 * pi * radius_deg * f) / f; });
}

double line_d_prime(const EyeFilter& eye, double width_deg, double window_sigma_deg, LineProfile profile) {
  const double limit = diffraction_limit_per_degree(eye.pupil_mm());
  // Along the line the spectrum is a Gaussian of this width; across it, the window changes nothing.
  const double spread = 1 / (2 * pi * window_sigma_deg);
  constexpr int across = 4000, along = 24;
  const double step = limit / across, along_step = 6 * spread / along;
  double sum = 0;
  for (int i = 0; i < across; ++i) {
    const double u = step * (i + 0.5);
    double stripe = std::sin(pi * width_deg * u) / (pi * u);
    if (profile == LineProfile::dipole) stripe *= 2 * std::sin(pi * width_deg * u);
    for (int j = -along; j <= along; ++j) {
      const double v = along_step * j;
      const double window = window_sigma_deg * std::sqrt(2 * pi) * std::exp(-v * v / (2 * spread * spread));
      sum += 2 * eye.detection_power(std::hypot(u, v)) * std::pow(stripe * window, 2);
    }
  }
  return std::sqrt(sum * step * along_step);
}

}  // namespace todbench
