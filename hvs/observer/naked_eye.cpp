// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/observer/naked_eye.h"

#include <cmath>
#include <complex>
#include <numbers>

#include "hvs/shape/polygon_spectrum.h"

namespace todbench {
namespace {

// Frequencies in cycles per square root of area. The spectra turn over at most twice the radius of a Landolt ring, 1.5
// lengths: 27 points for a turn. Of the products, 1e-4 lies above the last one.
constexpr double frequency_step = 0.025, most_frequency = 30;

/// The x in [low, high] at which a rising function of x reaches the share, to 1e-7 of x.
template <typename Function>
std::optional<double> crossing(double low, double high, double share, Function probability) {
  if (!(probability(low) < share && probability(high) > share)) return std::nullopt;
  while (high > low * (1 + 1e-7)) {
    const double middle = std::sqrt(low * high);
    (probability(middle) < share ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

}  // namespace

Polygon landolt_ring() {
  constexpr double outer = 2.5, inner = 1.5, half_gap = 0.5;
  constexpr int steps = 48;  // the area of the ring is 0.3 % too small
  Polygon ring;
  const auto arc = [&](double radius, int from, int to) {
    const double gap = std::asin(half_gap / radius);
    const int direction = to > from ? 1 : -1;
    for (int i = from; i != to + direction; i += direction) {
      const double angle = gap + (2 * std::numbers::pi - 2 * gap) * i / steps;
      ring.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
  };
  arc(outer, 0, steps);
  arc(inner, steps, 0);
  return ring;
}

NakedEyeShape::NakedEyeShape(const Polygon& shape) : rule_(gauss_legendre(24)) {
  const Polygon unit = placed(shape, 1 / std::sqrt(area(shape)), {0, 0});
  for (double k = frequency_step / 2; k < most_frequency; k += frequency_step) {
    // The products of two spectra have at most about 2 pi k 1.8 = 11 k turns around the circle.
    const int quarter = 8 + static_cast<int>(3 * k);
    std::vector<std::complex<double>> spectrum(static_cast<std::size_t>(4 * quarter));
    for (int i = 0; i < 2 * quarter; ++i) {
      const double angle = std::numbers::pi / 2 * i / quarter;
      const auto here = static_cast<std::size_t>(i), opposite = static_cast<std::size_t>(i + 2 * quarter);
      spectrum[here] = polygon_spectrum(unit, k * std::cos(angle), k * std::sin(angle));
      spectrum[opposite] = std::conj(spectrum[here]);
    }
    std::array<double, 4> products{};
    for (int i = 0; i < 4 * quarter; ++i) {
      for (int o = 0; o < 4; ++o) {
        const auto turned = static_cast<std::size_t>((i + 4 * quarter - o * quarter) % (4 * quarter));
        products[static_cast<std::size_t>(o)] +=
            std::real(spectrum[static_cast<std::size_t>(i)] * std::conj(spectrum[turned]));
      }
    }
    for (double& product : products) product *= std::numbers::pi / (2 * quarter);
    around_.push_back(products);
  }
}

std::array<double, 4> NakedEyeShape::products(const EyeFilter& eye, double size_deg) const {
  // F(f) = S^2 F_1(S f), integrated over f = k / S.
  std::array<double, 4> out{};
  for (std::size_t i = 0; i < around_.size(); ++i) {
    const double k = frequency_step * (static_cast<double>(i) + 0.5);
    const double weight = eye.identification_power(k / size_deg) * k * frequency_step * size_deg * size_deg;
    for (std::size_t o = 0; o < 4; ++o) out[o] += weight * around_[i][o];
  }
  return out;
}

double NakedEyeShape::probability_correct(const EyeFilter& eye, double contrast_noise, double contrast,
                                          double size_deg) const {
  const std::array<double, 4> turned = products(eye, size_deg);
  KnownPositionTask task;
  for (std::size_t i = 0; i < 4; ++i) {
    task.mean[i] = contrast * turned[i];
    for (std::size_t j = 0; j < 4; ++j) task.gram[i][j] = turned[(j + 4 - i) % 4];
  }
  task.noise = std::sqrt(1 + std::pow(contrast_noise * contrast, 2) * turned[0]);
  return todbench::probability_correct(task, rule_);
}

std::optional<double> NakedEyeShape::threshold_deg(const EyeFilter& eye, double contrast_noise, double contrast,
                                                   double share_correct) const {
  return crossing(0.001, 3, share_correct,
                  [&](double size) { return probability_correct(eye, contrast_noise, contrast, size); });
}

std::optional<double> NakedEyeShape::threshold_contrast(const EyeFilter& eye, double contrast_noise, double size_deg,
                                                        double share_correct) const {
  return crossing(1e-6, 10, share_correct,
                  [&](double contrast) { return probability_correct(eye, contrast_noise, contrast, size_deg); });
}

}  // namespace todbench
