// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/schedule/even_phases.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "tod/schedule/schedule.h"

namespace todbench {
namespace {

constexpr std::size_t most_together = 2048;  // shifts in an ordered lattice; triangles with joint phases

double fraction(double x) {
  const double part = x - std::floor(x);
  return part < 1 ? part : 0;  // x just below a whole number
}

/// A whole-numbered vector of the dual lattice.
struct Harmonic {
  long x = 0, y = 0;
  [[nodiscard]] double squared() const { return static_cast<double>(x * x + y * y); }
};

/// A lattice that contains the whole numbers, by its dual: whole multiples of (a, 0) and (b, d), 0 <= b < a. It has a d
/// points in the unit square.
struct PhaseLattice {
  long a = 1, b = 0, d = 1;

  [[nodiscard]] bool dual_has(Harmonic h) const { return h.y % d == 0 && (h.x - h.y / d * b) % a == 0; }
  /// Its sides: v_i with u_i v_j = 1 or 0 for the dual's (a, 0) and (b, d).
  [[nodiscard]] cv::Point2d first() const {
    return {1.0 / static_cast<double>(a), -static_cast<double>(b) / static_cast<double>(a * d)};
  }
  [[nodiscard]] cv::Point2d second() const { return {0, 1.0 / static_cast<double>(d)}; }
  [[nodiscard]] std::vector<cv::Point2d> points() const {
    std::vector<cv::Point2d> all;
    for (long i = 0; i < a; ++i) {
      for (long j = 0; j < d; ++j) {
        const cv::Point2d p = static_cast<double>(i) * first() + static_cast<double>(j) * second();
        all.emplace_back(fraction(p.x), fraction(p.y));
      }
    }
    return all;
  }
  /// Squared length of the shortest vector of the dual (Gauss's reduction).
  [[nodiscard]] double shortest() const {
    Harmonic u{a, 0}, v{b, d};
    if (u.squared() > v.squared()) std::swap(u, v);
    for (;;) {
      const double inner = static_cast<double>(u.x * v.x + u.y * v.y);
      const long times = std::lround(inner / u.squared());
      v = {v.x - times * u.x, v.y - times * u.y};
      if (v.squared() >= u.squared()) return u.squared();
      std::swap(u, v);
    }
  }
};

/// Lattices with the longest shortest dual vector.
std::vector<PhaseLattice> best_lattices(int count) {
  constexpr std::size_t most = 6;
  std::vector<PhaseLattice> best;
  double longest = 0;
  for (long a = 1; a <= count; ++a) {
    if (count % a != 0) continue;
    for (long b = 0; b < a; ++b) {
      const PhaseLattice lattice{a, b, count / a};
      const double found = lattice.shortest();
      if (found > longest) best.clear();
      longest = std::max(longest, found);
      if (found == longest && best.size() < most) best.push_back(lattice);
    }
  }
  return best;
}

/// The points in the order of an additive recurrence, so that their beginnings are even too.
std::vector<cv::Point2d> ordered(std::vector<cv::Point2d> points) {
  if (points.size() > most_together) return points;
  const auto wrapped = [](double difference) { return std::abs(difference - std::round(difference)); };
  std::vector<cv::Point2d> out;
  for (const cv::Point2d& wish : plastic_points(static_cast<int>(points.size()))) {
    const auto nearest = std::ranges::min_element(
        points, {}, [&](const cv::Point2d& p) { return std::hypot(wrapped(p.x - wish.x), wrapped(p.y - wish.y)); });
    out.push_back(*nearest);
    points.erase(nearest);
  }
  return out;
}

/// Fourier coefficient of 3/2 - x (1 - x), the kernel of the discrepancy along one axis.
double kernel_weight(long k) {
  return k == 0 ? 4.0 / 3 : 1 / (2 * std::numbers::pi * std::numbers::pi * static_cast<double>(k * k));
}

std::vector<Harmonic> harmonics_of(const PhaseLattice& lattice) {
  // About 2 * 7 * 7 of them, for every lattice; one of each pair of opposite ones.
  const long reach = std::lround(std::ceil(7 * std::sqrt(static_cast<double>(lattice.a * lattice.d))));
  std::vector<Harmonic> all;
  for (long y = 0; y <= reach; y += lattice.d) {
    for (long x = y == 0 ? 1 : -reach; x <= reach; ++x) {
      if (lattice.dual_has({x, y})) all.push_back({x, y});
    }
  }
  return all;
}

/// The sum of squared discrepancies as a function of the places of the groups. A set of triangles with sums a_g(h) of
/// waves over group g has the squared discrepancy sum_h w(h) |sum_g a_g(h) wave(h, c_g)|^2 / n^2.
class GroupPlacement {
 public:
  GroupPlacement(std::span<const PhasedTriangle> triangles, std::size_t groups, const PhaseLattice& lattice)
      : harmonics_(harmonics_of(lattice)), places_(groups), waves_(groups, Waves(harmonics_.size(), 1)) {
    std::map<double, double> of_size;
    for (const PhasedTriangle& t : triangles) of_size[t.size] += 1;
    std::map<std::pair<double, int>, Set> sets;
    for (const PhasedTriangle& t : triangles) {
      const Waves at = waves(t.position_px);
      for (const int which : {-1, static_cast<int>(t.apex)}) {
        Set& set = sets[{t.size, which}];
        set.sums.resize(groups, Waves(harmonics_.size()));
        // The mean over the shifts of an orientation is a part of that over all: weight (n_o / n)^2 / n_o^2.
        set.weight = 1 / (of_size[t.size] * of_size[t.size]);
        for (std::size_t k = 0; k < harmonics_.size(); ++k) set.sums[t.group][k] += at[k];
      }
    }
    for (auto& [key, set] : sets) sets_.push_back(std::move(set));
    const cv::Point2d middle = 0.5 * (lattice.first() + lattice.second());
    for (const cv::Point2d& p : plastic_points(128)) {
      const cv::Point2d in_cell = p.x * lattice.first() + p.y * lattice.second();
      coarse_.push_back({in_cell, waves(in_cell)});
      fine_.push_back({0.15 * (in_cell - middle), waves(0.15 * (in_cell - middle))});
    }
  }

  /// Moves one group after the other except the first; returns the final sum.
  double descend() {
    constexpr int sweeps = 12;
    for (const std::vector<Step>* steps : {&coarse_, &fine_}) {
      for (int sweep = 0; sweep < sweeps; ++sweep) {
        bool moved = false;
        for (std::size_t g = 1; g < places_.size(); ++g) moved = place(g, *steps) || moved;
        if (!moved) break;
      }
    }
    return sum();
  }

  [[nodiscard]] const std::vector<cv::Point2d>& places() const { return places_; }

 private:
  using Waves = std::vector<std::complex<double>>;  ///< one per harmonic
  struct Set {
    double weight = 0;
    std::vector<Waves> sums;  ///< per group
  };
  struct Step {
    cv::Point2d by;
    Waves turns;
  };

  [[nodiscard]] Waves waves(cv::Point2d at) const {
    Waves all;
    for (const Harmonic h : harmonics_) {
      const double turns = static_cast<double>(h.x) * at.x + static_cast<double>(h.y) * at.y;
      all.push_back(std::polar(1.0, 2 * std::numbers::pi * turns));
    }
    return all;
  }

  /// Sum over all groups except one.
  [[nodiscard]] std::complex<double> total(const Set& set, std::size_t k, std::size_t without) const {
    std::complex<double> sum = 0;
    for (std::size_t g = 0; g < places_.size(); ++g) {
      if (g != without) sum += set.sums[g][k] * waves_[g][k];
    }
    return sum;
  }

  [[nodiscard]] double weight(std::size_t k) const {
    return kernel_weight(harmonics_[k].x) * kernel_weight(harmonics_[k].y);
  }

  [[nodiscard]] double sum() const {
    double all = 0;
    for (const Set& set : sets_) {
      for (std::size_t k = 0; k < harmonics_.size(); ++k)
        all += 2 * set.weight * weight(k) * std::norm(total(set, k, places_.size()));
    }
    return all;
  }

  /// Moves a group by the best of the steps, if any; returns whether it moved.
  bool place(std::size_t group, const std::vector<Step>& steps) {
    Waves slope(harmonics_.size());
    for (std::size_t k = 0; k < harmonics_.size(); ++k) {
      for (const Set& set : sets_)
        slope[k] += set.weight * std::conj(total(set, k, group)) * set.sums[group][k] * waves_[group][k];
      slope[k] *= weight(k);
    }
    // Part of the sum that depends on the place of the group, halved.
    double least = 0;
    for (const auto& s : slope) least += s.real();
    const Step* best = nullptr;
    for (const Step& step : steps) {
      double found = 0;
      for (std::size_t k = 0; k < slope.size(); ++k)
        found += slope[k].real() * step.turns[k].real() - slope[k].imag() * step.turns[k].imag();
      if (found < least - 1e-12) {
        least = found;
        best = &step;
      }
    }
    if (best == nullptr) return false;
    places_[group] += best->by;
    for (std::size_t k = 0; k < slope.size(); ++k) waves_[group][k] *= best->turns[k];
    return true;
  }

  std::vector<Harmonic> harmonics_;
  std::vector<Set> sets_;
  std::vector<Step> coarse_, fine_;
  std::vector<cv::Point2d> places_;
  std::vector<Waves> waves_;  ///< at the places
};

}  // namespace

std::vector<PhasedTriangle> phased_triangles(const TargetPlate& plate, Mounting mounting, cv::Size2d pixel_mm,
                                             std::size_t group) {
  std::vector<PhasedTriangle> all;
  const TargetPlate held = mounted(plate, mounting);
  for (const PlateTriangle& t : held.triangles) {
    const cv::Point2d px(t.position_mm.x / pixel_mm.width, t.position_mm.y / pixel_mm.height);
    all.push_back({.group = group, .size = t.size_mm, .apex = t.apex, .position_px = px});
  }
  return all;
}

double least_harmonic(int count) {
  return std::sqrt(best_lattices(count).front().shortest());
}

EvenPhases even_phases(std::span<const PhasedTriangle> triangles, std::size_t groups, int count) {
  assert(groups > 0);
  EvenPhases out;
  out.shifts.resize(groups);
  if (count < 1) return out;
  std::vector<PhasedTriangle> shown;
  if (triangles.size() <= most_together) shown.assign(triangles.begin(), triangles.end());
  if (shown.empty()) {
    for (std::size_t g = 0; g < groups; ++g)
      shown.push_back({.group = g, .size = 1, .apex = Apex::up, .position_px = {}});
  }
  PhaseLattice lattice;
  std::vector<cv::Point2d> places;
  double least = std::numeric_limits<double>::infinity();
  for (const PhaseLattice& candidate : best_lattices(count)) {
    GroupPlacement placement(shown, groups, candidate);
    const double found = placement.descend();
    // Of equal ones within rounding: the first.
    if (!(places.empty() || found < least * (1 - 1e-9))) continue;
    least = found;
    lattice = candidate;
    places = placement.places();
  }
  out.cell[0] = lattice.first();
  out.cell[1] = lattice.second();
  const std::vector<cv::Point2d> points = ordered(lattice.points());
  for (std::size_t g = 0; g < groups; ++g) {
    for (const cv::Point2d& p : points)
      out.shifts[g].emplace_back(fraction(p.x + places[g].x), fraction(p.y + places[g].y));
  }
  return out;
}

}  // namespace todbench
