// SPDX-License-Identifier: GPL-3.0-or-later
// Profile across four bars from samples at many places, with one line spread for all edges.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace todbench {

/// A line spread of cubic B-splines over evenly spaced knots, its integral the edge spread, and four bars made of eight
/// edges.
class BarsProfile {
 public:
  BarsProfile(double first_knot, double step, double bar_width, double middle, double ground,
              std::vector<double> coefficients);
  /// Value at a place; smooth everywhere.
  [[nodiscard]] double value(double place) const;

 private:
  [[nodiscard]] double edge(double place) const;
  double first_knot_, step_, width_, middle_, ground_;
  std::vector<double> coefficients_, sums_;  ///< sums_[i]: sum of the coefficients before i
};

/// Least-squares fit of ground level and line spread to samples at fixed places. A small cost on the third differences
/// of the line spread (1e-6 of the mean diagonal) determines the parts that four bars do not show; it does not change
/// the profile. Immutable, thread-safe.
class BarsFit {
 public:
  /// Places, bar width, middle and knots have one unit. The line spread reaches 4 units to both sides, so an error of
  /// the middle moves it and changes no value. Empty if there are too few places.
  [[nodiscard]] static std::optional<BarsFit> of(const std::vector<double>& places, double bar_width, double middle,
                                                 double knot_step);
  /// Precondition: as many values as places.
  [[nodiscard]] BarsProfile profile(const std::vector<double>& values) const;
  /// Number of samples minus the trace of the smoothing matrix.
  [[nodiscard]] double degrees_of_freedom() const { return freedom_; }

 private:
  double first_knot_ = 0, step_ = 0, width_ = 0, middle_ = 0, freedom_ = 0;
  cv::Mat1d solution_;  ///< values -> ground and coefficients
};

}  // namespace todbench
