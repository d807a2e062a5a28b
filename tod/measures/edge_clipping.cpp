#include "tod/measures/edge_clipping.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace todbench {
namespace {

/// The samples of one side, mirrored so that their level is the upper end.
struct Side {
  std::vector<EdgeSample> samples;  ///< t > 0 towards the level
  double highest = -std::numeric_limits<double>::infinity();
};

Side side_of(const std::vector<EdgeSample>& samples, double sign) {
  Side side;
  for (const EdgeSample& sample : samples) {
    side.samples.push_back({sign * sample.t, sign * sample.value, sample.row});
    side.highest = std::max(side.highest, side.samples.back().value);
  }
  return side;
}

/// The plateau beyond the profile: how it scatters, and how much of it sits on the highest value.
struct Plateau {
  double sd = 0, share_at_highest = 0;
  int count = 0;
};

Plateau plateau_of(const Side& side, double from) {
  Plateau plateau;
  double sum = 0, square = 0;
  int at_highest = 0;
  for (const EdgeSample& sample : side.samples) {
    if (sample.t < from) continue;
    const double value = sample.value - side.highest;
    ++plateau.count;
    sum += value, square += value * value;
    at_highest += value == 0 ? 1 : 0;
  }
  if (plateau.count < 2) return plateau;
  plateau.sd = std::sqrt(std::max(0.0, square - sum * sum / plateau.count) / (plateau.count - 1));
  plateau.share_at_highest = at_highest / static_cast<double>(plateau.count);
  return plateau;
}

/// Mean slope of the profile over a stretch before it first reaches the highest value.
double corner_slope(const Side& side, double stretch_pitch) {
  double first = std::numeric_limits<double>::infinity();
  for (const EdgeSample& sample : side.samples) {
    if (sample.value == side.highest) first = std::min(first, sample.t);
  }
  double rise = 0, way = 0;
  for (const EdgeSample& sample : side.samples) {
    if (sample.t >= first || sample.t < first - stretch_pitch) continue;
    rise += side.highest - sample.value, way += first - sample.t;
  }
  return way > 0 ? rise / way : 0;
}

}  // namespace

std::optional<std::string_view> clipped_side(const std::vector<EdgeSample>& samples, const EdgeLevels& levels) {
  const double step = levels.bright - levels.dark;
  const double from = 2 * levels.width_pitch + 1;
  const Side bright = side_of(samples, 1), dark = side_of(samples, -1);
  const Plateau of_bright = plateau_of(bright, from), of_dark = plateau_of(dark, from);
  const auto cut = [&](const Side& side, const Plateau& own, const Plateau& other) {
    // Values that scatter meet their largest once in a while, not in every tenth pixel.
    const double negligible = 1e-6 * step;
    if (own.count >= 20 && own.share_at_highest > 0.1 && own.sd > negligible && own.share_at_highest < 0.9 &&
        own.sd > 0.5 * levels.count_step)
      return true;
    if (own.count >= 20 && own.share_at_highest > 0.25 && own.sd < 0.2 * other.sd &&
        other.sd > std::max(negligible, 0.5 * levels.count_step))
      return true;
    // A detector of full fill makes a ramp 0.8 pitch wide from 10 to 90 %, whose ends coarse counts turn into corners.
    const bool detector = levels.width_pitch <= 0.88 && levels.count_step > 1e-3 * step;
    return !detector && own.share_at_highest > 0.25 &&
           corner_slope(side, 0.3 * levels.width_pitch) > (0.1 + 6 * levels.count_step / step) * levels.steepest;
  };
  if (cut(bright, of_bright, of_dark)) return "bright";
  if (cut(dark, of_dark, of_bright)) return "dark";
  return std::nullopt;
}

}  // namespace todbench
