// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/psychometric/threshold_pair.h"

#include <algorithm>
#include <cmath>

namespace todbench {
namespace {

// Five joint parameters; Ties maps them to t, q and lapse of a set. The last two are always the lapses of A and B.
using JointPlace = std::array<double, 5>;
using Roles = std::array<std::size_t, 3>;
struct Ties {
  Roles a, b;
};
constexpr Ties shared_slope_separate{{0, 2, 3}, {1, 2, 4}};   // t of A, t of B, q
constexpr Ties shared_slope_common{{0, 2, 3}, {0, 2, 4}};     // t, unused, q
constexpr Ties separate_slopes_common{{0, 1, 3}, {0, 2, 4}};  // t, q of A, q of B

PsychometricPlace part(const JointPlace& place, const Roles& roles) {
  return {place[roles[0]], place[roles[1]], place[roles[2]]};
}

void add(Expansion<5>& sum, const Expansion<3>& e, const Roles& roles) {
  sum.value += e.value;
  for (std::size_t i = 0; i < 3; ++i) {
    sum.gradient[roles[i]] += e.gradient[i];
    for (std::size_t j = 0; j < 3; ++j) sum.hessian[roles[i]][roles[j]] += e.hessian[i][j];
  }
}

// The box of single fits, one limit pair for each role; parameters without a role are held at 0.
ParameterBox<5> joint_box(const Ties& ties, std::optional<double> lapse) {
  const ParameterBox<3> single = search_box(lapse);
  ParameterBox<5> box;
  for (const Roles& roles : {ties.a, ties.b}) {
    for (std::size_t i = 0; i < 3; ++i) {
      box.lower[roles[i]] = single.lower[i];
      box.upper[roles[i]] = single.upper[i];
    }
  }
  return box;
}

struct Joint {
  const PooledCounts& a;
  const PooledCounts& b;
  PsychometricForm form;
  std::optional<double> lapse;

  // The highest of the maxima reached from the starts.
  [[nodiscard]] Maximum<5> maximum(const Ties& ties, const std::vector<JointPlace>& starts) const {
    const auto likelihood = [&](const JointPlace& place) {
      Expansion<5> sum;
      sum.value = 0;
      add(sum, expand_likelihood(a, form, part(place, ties.a)), ties.a);
      add(sum, expand_likelihood(b, form, part(place, ties.b)), ties.b);
      return sum;
    };
    const ParameterBox<5> box = joint_box(ties, lapse);
    Maximum<5> best = climb<5>(likelihood, starts.front(), box);
    for (std::size_t i = 1; i < starts.size(); ++i) {
      const Maximum<5> m = climb<5>(likelihood, starts[i], box);
      if (m.expansion.value > best.expansion.value) best = m;
    }
    return best;
  }
};

std::optional<double> standard_error(const Maximum<5>& m) {
  if (!m.free[0] || !m.free[1] || !m.free[2]) return std::nullopt;  // at a slope limit there is no usable curvature
  const auto y = solve_information(m.expansion.hessian, {1, -1, 0, 0, 0}, m.free, 0);
  if (!y || !((*y)[0] - (*y)[1] > 0)) return std::nullopt;
  return std::sqrt((*y)[0] - (*y)[1]);
}

// Whether no neighbour in a list is above the value at i; ends count.
bool is_peak(const std::vector<double>& values, std::size_t i) {
  return (i == 0 || values[i] >= values[i - 1]) && (i + 1 == values.size() || values[i] >= values[i + 1]);
}

}  // namespace

ThresholdPair::ThresholdPair(std::span<const Level> a, std::span<const Level> b, const FitOptions& options)
    : a_(pool(a)), b_(pool(b)), form_(options.form), lapse_(options.fixed_lapse), grid_(scan_grid(form_, lapse_)) {
  const double shift = a_.relative(b_.reference_size);
  for (PooledLevel& level : b_.levels) level.ln_size += shift;
  b_.reference_size = a_.reference_size;
  scan_a_ = scan_likelihood(a_, grid_);
  scan_b_ = scan_likelihood(b_, grid_);
}

PairMaxima ThresholdPair::shared_slope() const {
  const Joint joint{a_, b_, form_, lapse_};
  const std::vector<ScanNode> nodes_both = scan_likelihood(pool(a_, b_), grid_).nodes;
  std::vector<double> apart, together;
  for (std::size_t i = 0; i < nodes_both.size(); ++i) {
    apart.push_back(scan_a_.nodes[i].value + scan_b_.nodes[i].value);
    together.push_back(nodes_both[i].value);
  }
  std::vector<JointPlace> separate, common;
  for (std::size_t i = 0; i < nodes_both.size(); ++i) {
    const PsychometricPlace &pa = scan_a_.nodes[i].place, &pb = scan_b_.nodes[i].place, &both = nodes_both[i].place;
    if (is_peak(apart, i))
      separate.push_back({pa[place_t], pb[place_t], pa[place_q], pa[place_lapse], pb[place_lapse]});
    if (is_peak(together, i)) common.push_back({both[place_t], 0, both[place_q], both[place_lapse], both[place_lapse]});
  }
  const Maximum<5> h1 = joint.maximum(shared_slope_separate, separate);
  // The best separate solution with a common mean threshold is a start as well.
  common.push_back({(h1.place[0] + h1.place[1]) / 2, 0, h1.place[2], h1.place[3], h1.place[4]});
  const Maximum<5> h0 = joint.maximum(shared_slope_common, common);
  return {h1.expansion.value, h0.expansion.value, h1.place[0] - h1.place[1], standard_error(h1)};
}

PairMaxima ThresholdPair::separate_slopes() const {
  const Joint joint{a_, b_, form_, lapse_};
  const Maximum<3> a = global_maximum(a_, form_, scan_a_, lapse_);
  const Maximum<3> b = global_maximum(b_, form_, scan_b_, lapse_);
  const double ta = a.place[place_t], tb = b.place[place_t];

  // The common threshold lies between the two or, if the likelihood has several peaks, near them.
  constexpr int points = 33;
  const double reach = 0.5 * std::abs(ta - tb) + 0.1;
  const double low = std::min(ta, tb) - reach, high = std::max(ta, tb) + reach;
  std::vector<double> values;
  std::vector<JointPlace> places;
  for (int i = 0; i < points; ++i) {
    const double t = low + (high - low) * i / (points - 1);
    const Maximum<3> pa = profile_maximum(a_, form_, grid_, lapse_, t);
    const Maximum<3> pb = profile_maximum(b_, form_, grid_, lapse_, t);
    values.push_back(pa.expansion.value + pb.expansion.value);
    places.push_back({t, pa.place[place_q], pb.place[place_q], pa.place[place_lapse], pb.place[place_lapse]});
  }
  std::vector<JointPlace> starts;
  for (std::size_t i = 0; i < places.size(); ++i)
    if (is_peak(values, i)) starts.push_back(places[i]);
  const Maximum<5> h0 = joint.maximum(separate_slopes_common, starts);

  const auto variance = [](const Maximum<3>& m) -> std::optional<double> {
    const auto column = solve_information(m.expansion.hessian, {1, 0, 0}, m.free, 0);
    if (!column || !m.free[place_t] || !m.free[place_q] || !((*column)[place_t] > 0)) return std::nullopt;
    return (*column)[place_t];
  };
  const auto va = variance(a), vb = variance(b);
  PairMaxima maxima{a.expansion.value + b.expansion.value, h0.expansion.value, ta - tb, std::nullopt};
  if (va && vb) maxima.se_ln_ratio = std::sqrt(*va + *vb);
  return maxima;
}

}  // namespace todbench
