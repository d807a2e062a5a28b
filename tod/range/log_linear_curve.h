// SPDX-License-Identifier: GPL-3.0-or-later
// A threshold over frequency (MRTD or contrast threshold function) as points with linear interpolation of its
// logarithm.
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

/// ln(value) is linear in frequency between points: exact for a exp(b f). Undefined outside the points. Immutable.
class LogLinearCurve {
 public:
  /// Errors: `invalid_input` in one sentence (fewer than two points, frequencies that do not increase, values that are
  /// not positive and finite). `what`: name of the curve in messages, "MRTD".
  [[nodiscard]] static Result<LogLinearCurve> of(std::span<const CurvePoint> points, std::string_view what);

  [[nodiscard]] std::span<const CurvePoint> points() const { return points_; }
  /// Value at a frequency; empty outside the points.
  [[nodiscard]] std::optional<double> at(double frequency) const;
  /// The highest frequency whose value is at most `value`; empty if every point lies above.
  [[nodiscard]] std::optional<double> highest_frequency_at(double value) const;
  /// Integral of sqrt(value / curve) over all frequencies at which the curve lies below `value`, in closed form between
  /// points; 0 if it lies above everywhere.
  [[nodiscard]] double root_excess_integral(double value) const;

 private:
  explicit LogLinearCurve(std::vector<CurvePoint> points);
  std::vector<CurvePoint> points_;
  std::vector<double> logs_;
};

}  // namespace todbench
