// SPDX-License-Identifier: GPL-3.0-or-later
// Maximum of a smooth function of a few variables inside a box: damped Newton steps with analytic derivatives.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

namespace todbench {

/// Value, gradient and second derivatives of a function at one point.
template <std::size_t N>
struct Expansion {
  double value = -std::numeric_limits<double>::infinity();
  std::array<double, N> gradient{};
  std::array<std::array<double, N>, N> hessian{};
};

/// A box. A variable with equal limits is fixed.
template <std::size_t N>
struct ParameterBox {
  std::array<double, N> lower{}, upper{};
};

/// Result of climb().
template <std::size_t N>
struct Maximum {
  std::array<double, N> place{};
  Expansion<N> expansion;
  std::array<bool, N> free{};  ///< false: fixed, or at a limit with the gradient pointing outwards
};

/// Solves M y = r for the free variables by Cholesky decomposition, with M = -hessian + damping |diagonal|; empty if M
/// is not positive definite.
template <std::size_t N>
[[nodiscard]] std::optional<std::array<double, N>> solve_information(
    const std::array<std::array<double, N>, N>& hessian, const std::array<double, N>& r,
    const std::array<bool, N>& free, double damping) {
  std::array<std::array<double, N>, N> c{};
  std::array<double, N> y{};
  for (std::size_t i = 0; i < N; ++i) {
    if (!free[i]) continue;
    for (std::size_t j = 0; j <= i; ++j) {
      if (!free[j]) continue;
      double sum = -hessian[i][j];
      if (i == j) sum += damping * std::max(std::abs(hessian[i][i]), 1e-300);
      const double scale = std::abs(sum);
      for (std::size_t k = 0; k < j; ++k) sum -= c[i][k] * c[j][k];
      if (i != j) {
        c[i][j] = sum / c[j][j];
      } else {
        if (!(sum > 1e-14 * scale) || !std::isfinite(sum)) return std::nullopt;  // 1e-14: singular to rounding
        c[i][i] = std::sqrt(sum);
      }
    }
  }
  for (std::size_t i = 0; i < N; ++i) {
    if (!free[i]) continue;
    double sum = r[i];
    for (std::size_t k = 0; k < i; ++k)
      if (free[k]) sum -= c[i][k] * y[k];
    y[i] = sum / c[i][i];
  }
  for (std::size_t i = N; i-- > 0;) {
    if (!free[i]) continue;
    double sum = y[i];
    for (std::size_t k = i + 1; k < N; ++k)
      if (free[k]) sum -= c[k][i] * y[k];
    y[i] = sum / c[i][i];
  }
  return y;
}

/// Returns which variables are free: not fixed, and not at a limit with the gradient pointing outwards.
template <std::size_t N>
[[nodiscard]] std::array<bool, N> free_variables(const std::array<double, N>& place,
                                                 const std::array<double, N>& gradient, const ParameterBox<N>& box) {
  std::array<bool, N> free{};
  for (std::size_t i = 0; i < N; ++i) {
    const bool held = !(box.lower[i] < box.upper[i]);
    const bool at_lower = place[i] <= box.lower[i] && gradient[i] <= 0;
    const bool at_upper = place[i] >= box.upper[i] && gradient[i] >= 0;
    free[i] = !held && !at_lower && !at_upper;
  }
  return free;
}

/// Returns whether value, gradient and second derivatives are finite.
template <std::size_t N>
[[nodiscard]] bool is_finite(const Expansion<N>& e) {
  if (!std::isfinite(e.value)) return false;
  for (std::size_t i = 0; i < N; ++i) {
    if (!std::isfinite(e.gradient[i])) return false;
    for (std::size_t j = 0; j < N; ++j)
      if (!std::isfinite(e.hessian[i][j])) return false;
  }
  return true;
}

/// Finds a maximum by Newton steps from `start`, with Levenberg-Marquardt damping. A variable at a limit is released
/// when the gradient points inwards. If the gain of a step is below the rounding error of the value, the step is
/// accepted if it reduces the gradient. The accuracy of the maximum is therefore limited by the rounding error of the
/// gradient, not by that of the value. The search ends if no step improves the result. If the derivatives at `start`
/// are not finite, `start` is returned unchanged.
template <std::size_t N, typename Function>
[[nodiscard]] Maximum<N> climb(const Function& function, std::array<double, N> start, const ParameterBox<N>& box) {
  for (std::size_t i = 0; i < N; ++i) start[i] = std::clamp(start[i], box.lower[i], box.upper[i]);
  Maximum<N> at{start, function(start), {}};
  double damping = 0;
  constexpr int max_steps = 80;            // quadratic convergence takes fewer than 10 steps; a ridge may take all
                                           // steps
  constexpr double smallest_step = 1e-14;  // in ln threshold and ln slope
  for (int step_count = 0; step_count < max_steps && is_finite(at.expansion); ++step_count) {
    at.free = free_variables(at.place, at.expansion.gradient, box);
    const auto step = solve_information(at.expansion.hessian, at.expansion.gradient, at.free, damping);
    if (!step) {
      damping = std::max(damping * 10, 1e-3);
      if (damping > 1e12) break;
      continue;
    }
    std::array<double, N> next = at.place;
    double largest = 0, predicted = 0;
    for (std::size_t i = 0; i < N; ++i) {
      if (!at.free[i]) continue;
      next[i] = std::clamp(at.place[i] + (*step)[i], box.lower[i], box.upper[i]);
      largest = std::max(largest, std::abs(next[i] - at.place[i]));
      predicted += at.expansion.gradient[i] * (*step)[i] / 2;
    }
    if (largest <= smallest_step) break;
    const Expansion<N> there = function(next);
    bool accepted = is_finite(there) && there.value > at.expansion.value;
    const double rounding = 1e-11 * (1 + std::abs(at.expansion.value));
    if (is_finite(there) && predicted < rounding && there.value > at.expansion.value - rounding) {
      const auto remaining = solve_information(at.expansion.hessian, there.gradient, at.free, damping);
      double left = 0;
      for (std::size_t i = 0; i < N; ++i)
        if (at.free[i]) left += there.gradient[i] * (*remaining)[i] / 2;
      accepted = left < predicted;
      if (!accepted && damping == 0) break;
    }
    if (accepted) {
      at.place = next;
      at.expansion = there;
      damping = damping < 1e-6 ? 0 : damping / 10;
    } else {
      damping = std::max(damping * 10, 1e-3);
      if (damping > 1e12) break;
    }
  }
  at.free = free_variables(at.place, at.expansion.gradient, box);
  return at;
}

}  // namespace todbench
