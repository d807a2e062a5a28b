// A threshold by frequency, MRTD or contrast threshold function, as points between which its logarithm is linear.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

struct CurvePoint {
  double frequency = 0;  ///< >= 0, in the unit that the curve says
  double value = 0;      ///< > 0
};

/// ln(value) is linear in frequency between points: exact for a exp(b f). Nothing is known outside. Immutable.
class LogLinearCurve {
 public:
  /// `invalid_input` in one sentence: fewer than two points, frequencies that do not increase, values that are not
  /// positive and finite. `what` is what messages call it: "MRTD".
  [[nodiscard]] static Result<LogLinearCurve> of(std::span<const CurvePoint> points, std::string_view what);

  [[nodiscard]] std::span<const CurvePoint> points() const { return points_; }
  /// Nothing outside the points.
  [[nodiscard]] std::optional<double> at(double frequency) const;
  /// The highest frequency whose value is at most `value`; nothing where every point lies above.
  [[nodiscard]] std::optional<double> highest_frequency_at(double value) const;
  /// Integral of sqrt(value / curve) over all frequencies at which the curve lies below `value`, in closed form between
  /// points; 0 where it lies above everywhere.
  [[nodiscard]] double root_excess_integral(double value) const;

 private:
  explicit LogLinearCurve(std::vector<CurvePoint> points);
  std::vector<CurvePoint> points_;
  std::vector<double> logs_;
};

}  // namespace todbench
