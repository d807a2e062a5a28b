// SPDX-License-Identifier: GPL-3.0-or-later
// A threshold as a function of frequency (MRTD or contrast threshold function), given by points. The logarithm of the
// threshold is interpolated linearly.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// One point of a curve.
struct CurvePoint {
  double frequency = 0;  ///< >= 0, in the unit of the curve
  double value = 0;      ///< > 0
};

/// A curve whose ln(value) is linear in frequency between points. The interpolation is exact for a exp(b f). Undefined
/// outside the points. Immutable.
class LogLinearCurve {
 public:
  /// Creates a curve. `what`: name of the curve in messages, for example "MRTD". Errors: `invalid_input` (fewer than
  /// two points, frequencies that do not increase, or values that are not positive and finite).
  [[nodiscard]] static Result<LogLinearCurve> of(std::span<const CurvePoint> points, std::string_view what);

  [[nodiscard]] std::span<const CurvePoint> points() const { return points_; }
  /// Returns the value at a frequency; empty outside the points.
  [[nodiscard]] std::optional<double> at(double frequency) const;
  /// Returns the highest frequency at which the curve is at most `value`. Empty if all points are above `value`.
  [[nodiscard]] std::optional<double> highest_frequency_at(double value) const;
  /// Returns the integral of sqrt(value / curve) over all frequencies at which the curve is below `value`. The integral
  /// is computed in closed form between points. 0 if the curve is above `value` everywhere.
  [[nodiscard]] double root_excess_integral(double value) const;

 private:
  explicit LogLinearCurve(std::vector<CurvePoint> points);
  std::vector<CurvePoint> points_;
  std::vector<double> logs_;
};

}  // namespace todbench
