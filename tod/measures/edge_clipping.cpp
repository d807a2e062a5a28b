// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/edge_clipping.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

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

/// The plateau outside the profile: its scatter, and the share of it on the highest value.
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

/// Argument at which a falling function passes a value.
template <typename Function>
double falling_through(Function function, double value, double low, double high) {
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (function(middle) > value ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Difference of an edge from its bright level at t, as a share of the step: a detector of full fill after a normal
/// blur.
double lacking(double t, double blur) {
  const auto integral = [&](double z) {
    const double density = std::exp(-0.5 * z * z / (blur * blur)) / std::sqrt(2 * std::numbers::pi);
    return z * 0.5 * std::erfc(-z / (blur * std::numbers::sqrt2)) + blur * density;
  };
  return 1 - (integral(t + 0.5) - integral(t - 0.5));
}

/// corner_slope() over the steepest slope of an edge that is rounded and not clipped: the last count of the step is cut
/// off. A detector gives a sharper corner than any blur of the same width.
double rounded_corner(double width_pitch, double count_over_step, double stretch_pitch) {
  const double blur = falling_through([&](double s) { return -lacking(width_pitch / 2, s); }, -0.1, 0.05, width_pitch);
  const double first =
      falling_through([&](double t) { return lacking(t, blur); }, count_over_step, 0, 10 * width_pitch + 10);
  constexpr int places = 20;
  double rise = 0, way = 0;
  for (int i = 0; i < places; ++i) {
    const double before = stretch_pitch * (i + 0.5) / places;
    rise += lacking(first - before, blur), way += before;
  }
  constexpr double close = 1e-3;
  return rise / way / ((0.5 - lacking(close, blur)) / close);
}

}  // namespace

std::optional<std::string_view> clipped_side(const std::vector<EdgeSample>& samples, const EdgeLevels& levels) {
  const double step = levels.bright - levels.dark;
  const double from = 2 * levels.width_pitch + 1;
  const double stretch = 0.3 * levels.width_pitch, count = levels.count_step / step;
  const double cornered =
      std::max(0.1 + 6 * count, count > 0 ? 1.1 * rounded_corner(levels.width_pitch, count, stretch) : 0);
  const Side bright = side_of(samples, 1), dark = side_of(samples, -1);
  const Plateau of_bright = plateau_of(bright, from), of_dark = plateau_of(dark, from);
  // A detector of full fill gives a ramp 0.77 to 0.8 pitch wide from 10 to 90 %, whose ends coarse counts turn into
  // corners. Without blur they are corners, equal at both ends.
  const double bright_corner = corner_slope(bright, stretch), dark_corner = corner_slope(dark, stretch);
  const bool alike = std::abs(bright_corner - dark_corner) < 0.1 * std::max(bright_corner, dark_corner);
  const bool detector =
      levels.width_pitch <= 0.88 && (levels.count_step > 1e-3 * step || (alike && levels.width_pitch > 0.76));
  const auto cut = [&](double corner, const Plateau& own, const Plateau& other) {
    // Values that scatter reach their maximum rarely, not in every tenth pixel.
    const double negligible = 1e-6 * step;
    // A level between two counts is rounded to either, half a count from their middle.
    const double rounding = 0.52 * levels.count_step;
    if (own.count >= 20 && own.share_at_highest > 0.1 && own.sd > negligible && own.share_at_highest < 0.9 &&
        own.sd > rounding)
      return true;
    if (own.count >= 20 && own.share_at_highest > 0.25 && own.sd < 0.2 * other.sd &&
        other.sd > std::max(negligible, rounding))
      return true;
    return !detector && own.share_at_highest > 0.25 && corner > cornered * levels.steepest;
  };
  if (cut(bright_corner, of_bright, of_dark)) return "bright";
  if (cut(dark_corner, of_dark, of_bright)) return "dark";
  return std::nullopt;
}

}  // namespace todbench
