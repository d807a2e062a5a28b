// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of slanted edges with diffraction and halos, from their transfer function by numerical integration.
#pragma once

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "acquisition/base/rng.h"

namespace todbench::test {

/// Lens: circular aperture over a flat band, normal aberration, square detector. Halos: shares with normal blurs, and a
/// cross-talk with the line spread exp(-|t| / length) / (2 length).
struct TailedLens {
  double f_number = 1, shortest_um = 7.5, longest_um = 13, pitch_um = 47.5;
  double aberration_pitch = 0, detector_pitch = 0.895;
  std::vector<std::pair<double, double>> halos{};  ///< share, sigma in pitches
  double cross_talk = 0, cross_talk_length_pitch = 1;

  [[nodiscard]] double mean_wavelength_um() const { return 0.5 * (shortest_um + longest_um); }
  /// Relative to a source of the size of the picture: wider halos lower the contrast of all of it.
  [[nodiscard]] double mtf(double f, double angle_deg, double widest_pitch) const {
    TailedLens narrow = *this;
    double contrast = 1;
    std::erase_if(narrow.halos, [&](const auto& halo) {
      const bool wide = halo.second > widest_pitch;
      contrast -= wide ? halo.first : 0;
      return wide;
    });
    for (auto& halo : narrow.halos) halo.first /= contrast;
    narrow.cross_talk /= contrast;
    return narrow.mtf(f, angle_deg);
  }
  [[nodiscard]] double mtf(double f, double angle_deg) const {
    using std::numbers::pi;
    constexpr int lines = 8;
    double lens = 0;
    for (int i = 0; i < lines; ++i) {
      const double wavelength = shortest_um + (longest_um - shortest_um) * (i + 0.5) / lines;
      const double nu = f * wavelength * f_number / pitch_um;
      lens += nu < 1 ? 2 / pi * (std::acos(nu) - nu * std::sqrt(1 - nu * nu)) / lines : 0;
    }
    double share = cross_talk, spread = cross_talk / (1 + std::pow(2 * pi * f * cross_talk_length_pitch, 2));
    for (const auto& [h, sigma] : halos) share += h, spread += h * std::exp(-2 * std::pow(pi * sigma * f, 2));
    const auto sinc = [](double x) { return std::abs(x) < 1e-9 ? 1.0 : std::sin(pi * x) / (pi * x); };
    const double angle = angle_deg * pi / 180;
    return (1 - share + spread) * lens * std::exp(-2 * std::pow(pi * aberration_pitch * f, 2)) *
           sinc(f * detector_pitch * std::cos(angle)) * sinc(f * detector_pitch * std::sin(angle));
  }
};

/// The edge's profile, 1/2 + (1 / pi) integral of MTF(f) sin(2 pi f t) / f df, tabulated: 1/40 pitch near the edge, 1/4
/// beyond 6 pitches, cubic interpolation.
class TailedProfile {
 public:
  TailedProfile(const TailedLens& lens, double angle_deg, double farthest_pitch = 120) {
    using std::numbers::pi;
    // Gauss-Legendre in panels. Halos of up to 50 pitches end at a frequency of 0.02; 15 points see 2 pi 120 x 0.02 =
    // 15 radians.
    using Rule = boost::math::quadrature::gauss<double, 15>;
    std::vector<double> frequency, weight;
    for (double from = 0; from < 6;) {
      const double half = from < 0.0199 ? 0.001 : 0.01;
      for (std::size_t i = 0; i < Rule::abscissa().size(); ++i) {
        for (const double side : {-1.0, 1.0}) {
          if (i == 0 && side > 0) continue;  // the middle
          const double f = from + half * (1 + side * Rule::abscissa()[i]);
          frequency.push_back(f);
          weight.push_back(half * Rule::weights()[i] * lens.mtf(f, angle_deg) / f / pi);
        }
      }
      from += 2 * half;
      if (from > 1 && lens.mtf(from, angle_deg) == 0) break;
    }
    const auto at = [&](double t) {
      double sum = 0.5;
      for (std::size_t i = 0; i < frequency.size(); ++i) sum += weight[i] * std::sin(2 * pi * frequency[i] * t);
      return sum;
    };
    for (int i = 0; i <= (near + 1) * 40; ++i) fine_.push_back(at(i / 40.0));
    for (int i = 0; i <= farthest_pitch * 4 + 4; ++i) coarse_.push_back(at(i / 4.0));
  }
  [[nodiscard]] double operator()(double t) const {
    const double r = std::abs(t);
    const double value = r < near ? cubic(fine_, r * 40) : cubic(coarse_, r * 4);
    return t < 0 ? 1 - value : value;
  }

 private:
  static constexpr int near = 6;
  [[nodiscard]] static double cubic(const std::vector<double>& table, double at) {
    const auto i = std::min(static_cast<std::size_t>(at), table.size() - 3);
    const double u = at - static_cast<double>(i);
    const double before = i > 0 ? table[i - 1] : 1 - table[1];
    const double a = table[i], b = table[i + 1], after = table[i + 2];
    return a + 0.5 * u * (b - before + u * (2 * before - 5 * a + 4 * b - after + u * (3 * (a - b) + after - before)));
  }
  std::vector<double> fine_, coarse_;
};

/// The bright side right; noise and shading as shares of the step. Shading rises by `dark` and `bright` over the half
/// picture of its side.
struct TailedEdge {
  double angle_deg = 5, edge_at_pitch = 0.2;  ///< from the middle of the picture
  int rows = 24, columns = 26;
  double noise = 0.0015, shading_dark = 0, shading_bright = 0;

  [[nodiscard]] cv::Mat1d picture(const TailedProfile& profile, std::uint64_t seed) const {
    const double angle = angle_deg * std::numbers::pi / 180;
    const RandomStream random(seed, "tailed edge");
    cv::Mat1d p(rows, columns);
    std::uint64_t draw = 0;
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < columns; ++x) {
        const double t =
            (x - 0.5 * (columns - 1) - edge_at_pitch) * std::cos(angle) + (y - 0.5 * (rows - 1)) * std::sin(angle);
        const double lit = profile(t);
        const double shading = (t < 0 ? shading_dark : shading_bright) * t / (0.5 * columns);
        p(y, x) = lit + shading + noise * random.normal(draw++);
      }
    }
    return p;
  }
};

}  // namespace todbench::test
