// SPDX-License-Identifier: GPL-3.0-or-later
// Profile across four bars, fitted to samples at many positions with the same line spread for all edges.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace todbench {

/// A profile of four bars with eight edges. The line spread is a sum of cubic B-splines over evenly spaced knots; its
/// integral is the edge spread.
class BarsProfile {
 public:
  BarsProfile(double first_knot, double step, double bar_width, double middle, double ground,
              std::vector<double> coefficients);
  /// Returns the value at a position; smooth everywhere.
  [[nodiscard]] double value(double place) const;

 private:
  [[nodiscard]] double edge(double place) const;
  double first_knot_, step_, width_, middle_, ground_;
  std::vector<double> coefficients_, sums_;  ///< sums_[i]: sum of the coefficients before i
};

/// Least-squares fit of ground level and line spread to samples at fixed positions. Some components of the line spread
/// have no effect on the profile of four bars. A small penalty on the third differences of the line spread (weight:
/// 1e-6 of the mean diagonal element of the normal matrix) determines these components. Immutable, thread-safe.
class BarsFit {
 public:
  /// Prepares the fit. `places`: positions of the samples. Positions, bar width, middle and knots have the same unit.
  /// The line spread extends 4 units to both sides, so an error of `middle` only shifts the line spread and does not
  /// change the values. Empty if there are too few samples.
  [[nodiscard]] static std::optional<BarsFit> of(const std::vector<double>& places, double bar_width, double middle,
                                                 double knot_step);
  /// Fits the values. Precondition: one value for each position.
  [[nodiscard]] BarsProfile profile(const std::vector<double>& values) const;
  /// Returns the number of samples minus the trace of the smoothing matrix.
  [[nodiscard]] double degrees_of_freedom() const { return freedom_; }

 private:
  double first_knot_ = 0, step_ = 0, width_ = 0, middle_ = 0, freedom_ = 0;
  cv::Mat1d solution_;  ///< values -> ground and coefficients
};

}  // namespace todbench
