// SPDX-License-Identifier: GPL-3.0-or-later
// Smooth curve through a large number of samples of an edge: least squares with cubic B-splines.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace todbench {

/// Evenly spaced knots from `start`; the domain is [start, start + cells * step].
struct SplineGrid {
  double start = 0, step = 0.25;
  int cells = 0;
  [[nodiscard]] double end() const { return start + cells * step; }
  [[nodiscard]] std::size_t coefficients() const { return static_cast<std::size_t>(cells) + 3; }
};

/// A curve on a grid.
struct Spline {
  SplineGrid grid;
  std::vector<double> coefficients;
  /// Returns the value at t. Precondition: t on the grid.
  [[nodiscard]] double value(double t) const;
  [[nodiscard]] double slope(double t) const;
};

/// Normal equations of a fit. The equations are sums over samples, so a part of the samples can be removed later by
/// subtraction.
class SplineSums {
 public:
  explicit SplineSums(const SplineGrid& grid);
  /// Adds a sample. Ignores samples outside the grid.
  void add(double t, double value);
  SplineSums& operator+=(const SplineSums& other);
  SplineSums& operator-=(const SplineSums& other);
  [[nodiscard]] double samples() const { return samples_; }
  /// Returns the least-squares curve. A small penalty on third differences determines the curve in intervals without
  /// samples. The penalty changes the amplitude of a wave with half a cycle per four knots by less than 1e-5. Empty if
  /// there are fewer samples than coefficients.
  [[nodiscard]] std::optional<Spline> solve() const;

 private:
  SplineGrid grid_;
  /// For each row, the diagonal element and the three elements to the right of it.
  std::vector<std::array<double, 4>> band_;
  std::vector<double> right_;
  double samples_ = 0;
};

}  // namespace todbench
