// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of slanted edges whose MTF is known exactly.
#pragma once

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

#include "acquisition/base/rng.h"

namespace todbench::test {

/// A half plane, blurred by a normal distribution, on square detectors. The normal of the edge is (cos, sin) of the
/// angle; values from 0 to 1, the bright side right.
struct EdgePicture {
  double blur_sigma_pitch = 0.3;
  double detector_pitch = 0.895;
  double angle_deg = 5;
  double edge_at_pitch = 20.2;  ///< in the middle row
  int rows = 80, columns = 41;

  [[nodiscard]] double cosine() const { return std::cos(angle_deg * std::numbers::pi / 180); }
  [[nodiscard]] double sine() const { return std::sin(angle_deg * std::numbers::pi / 180); }

  /// Twice integrated normal distribution.
  [[nodiscard]] double twice_integrated(double t) const {
    const double s = blur_sigma_pitch;
    const double above = 0.5 * std::erfc(-t / s / std::numbers::sqrt2);
    const double density = std::exp(-0.5 * t * t / (s * s)) / std::sqrt(2 * std::numbers::pi);
    return 0.5 * ((t * t + s * s) * above + t * s * density);
  }
  /// Mean of a detector whose centre lies at t along the normal.
  [[nodiscard]] double profile(double t) const {
    const double a = 0.5 * detector_pitch * cosine(), b = std::abs(0.5 * detector_pitch * sine());
    return (twice_integrated(t + a + b) - twice_integrated(t + a - b) - twice_integrated(t - a + b) +
            twice_integrated(t - a - b)) /
           (4 * a * b);
  }
  [[nodiscard]] cv::Mat1d picture() const {
    cv::Mat1d p(rows, columns);
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < columns; ++x)
        p(y, x) = profile((x - edge_at_pitch) * cosine() + (y - 0.5 * (rows - 1)) * sine());
    }
    return p;
  }
  /// With white noise, as a share of the step.
  [[nodiscard]] cv::Mat1d noisy(double noise_over_step, std::uint64_t seed) const {
    cv::Mat1d p = picture();
    const RandomStream random(seed, "edge noise");
    for (int i = 0; i < static_cast<int>(p.total()); ++i)
      p(i / columns, i % columns) +=
          noise_over_step * static_cast<double>(random.normal(static_cast<std::uint64_t>(i)));
    return p;
  }
  /// Along the normal, at a frequency in cycles per pitch.
  [[nodiscard]] double mtf(double frequency) const {
    const auto sinc = [](double x) { return x == 0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x); };
    return std::exp(-2 * std::pow(std::numbers::pi * blur_sigma_pitch * frequency, 2)) *
           std::abs(sinc(frequency * detector_pitch * cosine()) * sinc(frequency * detector_pitch * sine()));
  }
};

}  // namespace todbench::test
