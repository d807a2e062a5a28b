// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/range/bars_sampled.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "hvs/shape/gauss_legendre.h"

namespace todbench {
namespace {

constexpr double pi = std::numbers::pi;

/// Spectrum of the pattern at u: four bars of width w, centres at -3 w, -w, w and 3 w.
double bars_spectrum(double u, double width) {
  const double bar = u == 0 ? width : std::sin(pi * u * width) / (pi * u);
  return 2 * bar * (std::cos(2 * pi * u * width) + std::cos(6 * pi * u * width));
}

struct Sampled {
  std::array<double, 4> bars{};
  std::array<double, 3> gaps{};

  [[nodiscard]] double modulation() const {
    return (bars[0] + bars[1] + bars[2] + bars[3]) / 4 - (gaps[0] + gaps[1] + gaps[2]) / 3;
  }
  [[nodiscard]] int separated() const {
    int count = 1;
    for (std::size_t i = 0; i < gaps.size(); ++i) count += gaps[i] < bars[i] && gaps[i] < bars[i + 1] ? 1 : 0;
    return count;
  }
};

template <typename Profile>
Sampled sampled_at(const Profile& profile, double width, double phase) {
  const double reach = std::max(width / 2, 0.5);
  // The samples are at whole numbers + phase; rounding must not lose one exactly at the edge.
  const auto extreme = [&](double centre, auto better, double start) {
    constexpr double edge = 1e-9;
    for (double k = std::ceil(centre - reach - phase - edge); k + phase <= centre + reach + edge; ++k)
      start = better(start, profile(k + phase));
    return start;
  };
  const auto larger = [](double a, double b) { return std::max(a, b); };
  const auto smaller = [](double a, double b) { return std::min(a, b); };
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Sampled found;
  for (int i = 0; i < 4; ++i) found.bars[static_cast<std::size_t>(i)] = extreme((2 * i - 3) * width, larger, -infinity);
  for (int i = 0; i < 3; ++i) found.gaps[static_cast<std::size_t>(i)] = extreme((2 * i - 2) * width, smaller, infinity);
  return found;
}

template <typename Profile>
BarModulation over_phases(const Profile& profile, double frequency_per_pitch, int phases) {
  const double width = 1 / (2 * frequency_per_pitch);
  BarModulation found;
  found.best = -std::numeric_limits<double>::infinity();
  found.worst = std::numeric_limits<double>::infinity();
  for (int i = 0; i < phases; ++i) {
    const double phase = (i + 0.5) / phases - 0.5;
    const Sampled sampled = sampled_at(profile, width, phase);
    const double modulation = sampled.modulation();
    found.mean += modulation / phases;
    found.worst = std::min(found.worst, modulation);
    if (sampled.separated() == 4) found.share_of_four += 1.0 / phases;
    if (modulation > found.best) {
      found.best = modulation;
      found.best_phase_pitch = phase;
      found.bars_separated_at_best = sampled.separated();
    }
  }
  return found;
}

}  // namespace

BlurredBars::BlurredBars(double frequency_per_pitch, const std::function<double(double)>& transfer,
                         double band_per_pitch)
    : frequency_(frequency_per_pitch) {
  // The value is 2 int_0^band transfer spectrum cos(2 pi u x) du. At places within the pattern the integrand has at
  // most 8 w band waves; sixteen nodes integrate four of them to 1e-13.
  const double width = 1 / (2 * frequency_per_pitch);
  const int pieces = static_cast<int>(std::ceil(band_per_pitch * (2 * width + 0.5))) * 2 + 8;
  static const auto rule = gauss_legendre(16);
  const double half = band_per_pitch / pieces / 2;
  for (int i = 0; i < pieces; ++i) {
    for (const auto& [x, weight] : rule) {
      const double u = (2 * i + 1 + x) * half;
      node_frequency_.push_back(u);
      node_weight_.push_back(2 * half * weight * transfer(u) * bars_spectrum(u, width));
    }
  }
}

double BlurredBars::at(double x_pitch) const {
  double sum = 0;
  for (std::size_t i = 0; i < node_frequency_.size(); ++i)
    sum += node_weight_[i] * std::cos(2 * pi * node_frequency_[i] * x_pitch);
  return sum;
}

BarModulation bar_modulation(const BlurredBars& bars, int phases) {
  return over_phases([&](double x) { return bars.at(x); }, bars.frequency_per_pitch(), phases);
}

BarModulation bar_modulation(const std::function<double(double)>& profile, double frequency_per_pitch, int phases) {
  return over_phases(profile, frequency_per_pitch, phases);
}

}  // namespace todbench
