// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/psychometric/psychometric_profile.h"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <utility>

namespace todbench {
namespace {

constexpr double farthest = 900;  // in ln size; at slope 0.1 every level is at its asymptote long before

struct March {
  const PooledCounts& counts;
  PsychometricForm form;
  const ScanGrid& grid;
  std::optional<double> lapse;
  const ProfileRequest& request;
  std::optional<Maximum<3>> better;

  double drop_at(double t) {
    const Maximum<3> m = profile_maximum(counts, form, grid, lapse, t);
    const double tolerance = 1e-7 + 1e-14 * std::abs(request.supremum);
    if (m.expansion.value > request.supremum + tolerance && (!better || m.expansion.value > better->expansion.value))
      better = m;
    return 2 * (request.supremum - m.expansion.value);
  }

  std::optional<double> crossing(double inner, double inner_drop, double outer, double outer_drop, double drop) {
    if (outer_drop == drop) return outer;
    if (inner_drop >= drop) return inner;
    std::uintmax_t evaluations = 60;
    const auto tolerance = [](double a, double b) {
      return std::abs(a - b) < 1e-11 * (1 + std::min(std::abs(a), std::abs(b)));
    };
    if (outer < inner) {
      std::swap(inner, outer);
      std::swap(inner_drop, outer_drop);
    }
    const auto [a, b] = boost::math::tools::toms748_solve([&](double t) { return drop_at(t) - drop; }, inner, outer,
                                                          inner_drop - drop, outer_drop - drop, tolerance, evaluations);
    return (a + b) / 2;
  }
};

// Steps resolve the dips of the profile at the levels: a quarter of their mean distance; outside the levels they grow.
struct Steps {
  double first, largest_inside, lower, upper;

  [[nodiscard]] double next(double step, double t) const {
    const bool inside = t > lower && t < upper;
    return inside ? std::min(step * 1.05, largest_inside) : step * 1.25;
  }
};

Steps steps_for(const PooledCounts& counts, const ProfileRequest& request) {
  constexpr double margin = 0.1;
  const double range = counts.last() - counts.first();
  const double gap = counts.levels.size() > 1 ? range / static_cast<double>(counts.levels.size() - 1) : 0.1;
  const double inside = std::clamp(gap / 4, 1e-4, 0.1);
  const double first = request.se_t ? std::min(*request.se_t * 0.3, inside) : std::min(inside, 0.02);
  return {first, std::max(inside, first), counts.first() - margin, counts.last() + margin};
}

ProfileCrossings::Side march_out(March& march, double direction, double limit_drop) {
  const ProfileRequest& request = march.request;
  const bool wide_closes = limit_drop > request.wide_drop, narrow_closes = limit_drop > request.narrow_drop;
  ProfileCrossings::Side side;
  if (!narrow_closes) return side;
  const Steps steps = steps_for(march.counts, request);
  double inner = request.start_t, inner_drop = 0, step = steps.first;
  while (std::abs(inner) < farthest && !march.better) {
    const double outer = inner + direction * step;
    const double outer_drop = march.drop_at(outer);
    if (!side.narrow && outer_drop >= request.narrow_drop)
      side.narrow = march.crossing(inner, inner_drop, outer, outer_drop, request.narrow_drop);
    if (side.narrow && !wide_closes) return side;
    if (outer_drop >= request.wide_drop) {
      side.wide = march.crossing(inner, inner_drop, outer, outer_drop, request.wide_drop);
      return side;
    }
    inner = outer;
    inner_drop = outer_drop;
    step = steps.next(step, inner);
  }
  return side;
}

}  // namespace

ProfileCrossings profile_crossings(const PooledCounts& counts, PsychometricForm form, const ScanGrid& grid,
                                   std::optional<double> lapse, const ProfileRequest& request) {
  March march{counts, form, grid, lapse, request, std::nullopt};
  ProfileCrossings crossings;
  crossings.below = march_out(march, -1, 2 * (request.supremum - request.limits.ceiling));
  if (!march.better) crossings.above = march_out(march, +1, 2 * (request.supremum - request.limits.chance));
  crossings.better = march.better;
  return crossings;
}

}  // namespace todbench
