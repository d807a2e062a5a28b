// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/bounded_least_squares.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace todbench {
namespace {

constexpr double ridge = 1e-13;

/// Solves A z = b for a symmetric positive definite A (rows, overwritten) by its Cholesky factor.
void solve_in_place(std::vector<double>& a, std::vector<double>& b) {
  const std::size_t n = b.size();
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = j; i < n; ++i) {
      double sum = a[i * n + j];
      for (std::size_t k = 0; k < j; ++k) sum -= a[i * n + k] * a[j * n + k];
      if (i == j)
        a[j * n + j] = std::sqrt(std::max(sum, 0.1 * ridge));  // rounding of a dependent column
      else
        a[i * n + j] = sum / a[j * n + j];
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= a[i * n + k] * b[k];
    b[i] /= a[i * n + i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) b[i] -= a[k * n + i] * b[k];
    b[i] /= a[i * n + i];
  }
}

}  // namespace

BoundedLeastSquares::BoundedLeastSquares(const std::vector<double>& gram, const std::vector<double>& right,
                                         const std::vector<double>& low, const std::vector<double>& high)
    : n_(right.size()), scale_(n_, 1), gram_(gram), right_(right), low_(low), high_(high) {
  assert(gram.size() == n_ * n_ && low.size() == n_ && high.size() == n_);
  for (std::size_t i = 0; i < n_; ++i)
    if (gram[i * n_ + i] > 0) scale_[i] = 1 / std::sqrt(gram[i * n_ + i]);
  for (std::size_t i = 0; i < n_; ++i) {
    right_[i] *= scale_[i], low_[i] /= scale_[i], high_[i] /= scale_[i];
    for (std::size_t j = 0; j < n_; ++j) gram_[i * n_ + j] *= scale_[i] * scale_[j];
    gram_[i * n_ + i] += ridge;
  }
  State start{std::vector<double>(n_), std::vector<signed char>(n_)};
  for (std::size_t i = 0; i < n_; ++i) {
    start.bound[i] = std::isfinite(low_[i]) ? -1 : std::isfinite(high_[i]) ? 1 : 0;
    start.x[i] = start.bound[i] < 0 ? low_[i] : start.bound[i] > 0 ? high_[i] : 0;
  }
  scaled_best_ = solve(right_, std::move(start));
  best_ = {unscaled(scaled_best_.x), scaled_best_.bound};
  slope_at_best_.resize(n_);
  for (std::size_t i = 0; i < n_; ++i) {
    double sum = -right_[i];
    for (std::size_t j = 0; j < n_; ++j) sum += gram_[i * n_ + j] * scaled_best_.x[j];
    slope_at_best_[i] = scaled_best_.bound[i] == 0 ? 0 : sum;
  }
}

std::vector<double> BoundedLeastSquares::unscaled(std::vector<double> x) const {
  for (std::size_t i = 0; i < n_; ++i) x[i] *= scale_[i];
  return x;
}

std::vector<double> BoundedLeastSquares::free_minimum(const std::vector<double>& right, const State& state,
                                                      const std::vector<std::size_t>& free) const {
  const std::size_t m = free.size();
  std::vector<double> a(m * m), b(m);
  for (std::size_t i = 0; i < m; ++i) {
    const double* row = &gram_[free[i] * n_];
    b[i] = right[free[i]];
    for (std::size_t j = 0; j < n_; ++j)
      if (state.bound[j] != 0) b[i] -= row[j] * state.x[j];
    for (std::size_t j = 0; j <= i; ++j) a[i * m + j] = row[free[j]];
  }
  solve_in_place(a, b);
  return b;
}

BoundedLeastSquares::State BoundedLeastSquares::solve(const std::vector<double>& right, State state) const {
  const std::size_t most_steps = 20 * n_ + 50;
  std::vector<std::size_t> free;
  std::size_t released = n_;  // the last unknown that left its bound
  std::vector<bool> stuck(n_, false);
  for (std::size_t step = 0; step < most_steps; ++step) {
    free.clear();
    for (std::size_t i = 0; i < n_; ++i)
      if (state.bound[i] == 0) free.push_back(i);
    const std::vector<double> z = free_minimum(right, state, free);
    // Go towards the minimum of the free unknowns up to the first bound.
    double share = 1;
    std::size_t hit = n_;
    for (std::size_t k = 0; k < free.size(); ++k) {
      const std::size_t i = free[k];
      const double limit = z[k] < low_[i] ? low_[i] : high_[i];
      if (z[k] >= low_[i] && z[k] <= high_[i]) continue;
      const double room = (limit - state.x[i]) / (z[k] - state.x[i]);
      if (room < share || hit == n_) share = std::clamp(room, 0.0, share), hit = i;
    }
    for (std::size_t k = 0; k < free.size(); ++k) state.x[free[k]] += share * (z[k] - state.x[free[k]]);
    if (hit < n_) {
      for (const std::size_t i : free) state.x[i] = std::clamp(state.x[i], low_[i], high_[i]);
      const bool low = std::abs(state.x[hit] - low_[hit]) <= std::abs(state.x[hit] - high_[hit]);
      state.bound[hit] = low ? -1 : 1, state.x[hit] = low ? low_[hit] : high_[hit];
      // Rounding of a gradient may release an unknown that must return at once.
      if (hit == released) stuck[hit] = true;
      continue;
    }
    if (released < n_) std::fill(stuck.begin(), stuck.end(), false);
    released = n_;
    double most = 0;
    for (std::size_t i = 0; i < n_; ++i) {
      if (state.bound[i] == 0 || stuck[i] || low_[i] == high_[i]) continue;
      double pull = right[i], size = std::abs(right[i]);
      for (std::size_t j = 0; j < n_; ++j) {
        const double term = gram_[i * n_ + j] * state.x[j];
        pull -= term, size += std::abs(term);
      }
      const double gain = -state.bound[i] * pull;
      if (gain > 1e-14 * size && gain > most) most = gain, released = i;
    }
    if (released == n_) break;
    state.bound[released] = 0;
  }
  return state;
}

double BoundedLeastSquares::scaled_excess(const std::vector<double>& x) const {
  double sum = 0;
  for (std::size_t i = 0; i < n_; ++i) {
    const double d = x[i] - scaled_best_.x[i];
    double row = 2 * slope_at_best_[i];
    for (std::size_t j = 0; j < n_; ++j) row += gram_[i * n_ + j] * (x[j] - scaled_best_.x[j]);
    sum += d * row;
  }
  return std::max(0.0, sum);
}

double BoundedLeastSquares::excess(const std::vector<double>& x) const {
  std::vector<double> scaled = x;
  for (std::size_t i = 0; i < n_; ++i) scaled[i] /= scale_[i];
  return scaled_excess(scaled);
}

std::vector<double> BoundedLeastSquares::farthest(const std::vector<double>& direction, double allowed) const {
  std::vector<double> tilt(n_), tilted(n_);
  double length = 0;
  for (std::size_t i = 0; i < n_; ++i) tilt[i] = direction[i] * scale_[i], length += tilt[i] * tilt[i];
  if (!(length > 0) || !(allowed > 0)) return best();
  // The minimum of q - 2 m direction'x has the largest direction'x for its excess, which grows with m.
  const auto with = [&](double m, const State& from) {
    for (std::size_t i = 0; i < n_; ++i) tilted[i] = right_[i] + m * tilt[i];
    return solve(tilted, from);
  };
  double below = 0, at = std::sqrt(allowed / length);
  double below_root = 0;
  State inside = scaled_best_;
  State outside;
  double outside_root = 0;
  constexpr int most_doublings = 60, most_steps = 12;
  const double wanted = std::sqrt(allowed);
  bool beyond = false;
  for (int k = 0; k < most_doublings && !beyond; ++k) {
    outside = with(at, inside);
    outside_root = std::sqrt(scaled_excess(outside.x));
    beyond = outside_root >= wanted;
    if (beyond) break;
    inside = outside, below = at, below_root = outside_root;
    at *= outside_root > 0 ? std::clamp(1.05 * wanted / outside_root, 1.1, 8.0) : 8;
  }
  if (!beyond) return unscaled(inside.x);
  // The root of the excess is linear in m between changes of the active set.
  for (int k = 0; k < most_steps && outside_root - wanted > 1e-3 * wanted; ++k) {
    const double share = (wanted - below_root) / (outside_root - below_root);
    const double middle = below + std::clamp(k % 3 == 2 ? 0.5 : share, 0.01, 0.999) * (at - below);
    State found = with(middle, inside);
    const double root = std::sqrt(scaled_excess(found.x));
    if (std::abs(root - wanted) < 1e-3 * wanted) return unscaled(found.x);
    if (root < wanted)
      inside = std::move(found), below = middle, below_root = root;
    else
      outside = std::move(found), at = middle, outside_root = root;
  }
  return unscaled(outside.x);
}

}  // namespace todbench
