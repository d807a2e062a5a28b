// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/bar_pattern.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "hvs/shape/step_image.h"

namespace todbench {
namespace {

Polygon bar_outline(double left, double width, double half_length, BarAxis axis) {
  Polygon outline{{left, -half_length}, {left + width, -half_length}, {left + width, half_length}, {left, half_length}};
  if (axis == BarAxis::vertical) {
    for (auto& p : outline) std::swap(p.x, p.y);
  }
  return outline;
}

}  // namespace

std::vector<StepEdge> bar_edges(BarPattern pattern, double frequency_per_pitch, BarAxis axis) {
  const double side = 3.5 / frequency_per_pitch;
  const int bars = pattern == BarPattern::four_bars ? 4 : pattern == BarPattern::five_bars ? 5 : 1;
  const double width = side / (2 * bars - 1), level = pattern == BarPattern::uniform ? 4.0 / 7 : 1;
  std::vector<PaintedPolygon> painted;
  for (int i = 0; i < bars; ++i)
    painted.push_back({bar_outline(2 * i * width - side / 2, width, side / 2, axis), level});
  return visible_edges(painted);
}

std::vector<double> bar_energies(double frequency_per_pitch, BarPattern alternative, const TransferFunction& transfer,
                                 double band_per_pitch, int phases) {
  const double side = 3.5 / frequency_per_pitch;
  const int period = static_cast<int>(std::ceil(side)) + 24;  // blur beyond 12 pitches outside is far below 1e-9
  const FrequencyLattice lattice{.period = period, .band = static_cast<int>(std::ceil(band_per_pitch * period))};
  // Phases lie between points of a lattice twice as fine.
  int per_pitch = 2 * phases;
  while (period * per_pitch <= 2 * lattice.band) per_pitch *= 2;
  const FilterTable filter(lattice, transfer);
  const cv::Mat1d difference =
      fine_step_image(bar_edges(BarPattern::four_bars, frequency_per_pitch, BarAxis::horizontal), filter, per_pitch) -
      fine_step_image(bar_edges(alternative, frequency_per_pitch, BarAxis::horizontal), filter, per_pitch);
  const int n = period * per_pitch, step = per_pitch / phases;
  std::vector<double> energies;
  for (int q = 0; q < phases; ++q) {
    for (int p = 0; p < phases; ++p) {
      double sum = 0;
      for (int y = q * step + step / 2; y < n; y += per_pitch) {
        for (int x = p * step + step / 2; x < n; x += per_pitch) sum += difference(y, x) * difference(y, x);
      }
      energies.push_back(sum);
    }
  }
  return energies;
}

double ideal_two_interval_proportion(const std::vector<double>& energies, double contrast) {
  double sum = 0;
  for (const double energy : energies) sum += 0.5 * std::erfc(-contrast * std::sqrt(energy) / 2);
  return sum / static_cast<double>(energies.size());
}

double ideal_two_interval_contrast(const std::vector<double>& energies, double proportion) {
  double low = 0, high = 1;
  while (ideal_two_interval_proportion(energies, high) < proportion && high < 1e12) high *= 2;
  for (int i = 0; i < 200 && high - low > 1e-14 * high; ++i) {
    const double middle = (low + high) / 2;
    (ideal_two_interval_proportion(energies, middle) < proportion ? low : high) = middle;
  }
  return high;
}

}  // namespace todbench
