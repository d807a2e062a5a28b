// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/range/log_linear_curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

namespace todbench {
namespace {

/// Integral of exp(exponent) over a length on which the exponent is linear from a to b: length (e^b - e^a) / (b - a).
double mean_exponential(double a, double b) {
  const double d = b - a;
  return std::exp(a) * (std::abs(d) < 1e-12 ? 1 + d / 2 : std::expm1(d) / d);
}

}  // namespace

LogLinearCurve::LogLinearCurve(std::vector<CurvePoint> points) : points_(std::move(points)) {
  for (const auto& point : points_) logs_.push_back(std::log(point.value));
}

Result<LogLinearCurve> LogLinearCurve::of(std::span<const CurvePoint> points, std::string_view what) {
  if (points.size() < 2)
    return fail(ErrorCode::invalid_input, fmt::format("the {} curve needs at least two points", what));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& [frequency, value] = points[i];
    if (!std::isfinite(frequency) || frequency < 0)
      return fail(ErrorCode::invalid_input, fmt::format("a frequency of the {} curve must be 0 or more", what));
    if (!std::isfinite(value) || value <= 0) {
      return fail(ErrorCode::invalid_input,
                  fmt::format("the {} curve must be above 0, found {:g} at {:g}", what, value, frequency));
    }
    if (i > 0 && !(frequency > points[i - 1].frequency)) {
      return fail(ErrorCode::invalid_input,
                  fmt::format("frequencies of the {} curve must increase, found {:g} after {:g}", what, frequency,
                              points[i - 1].frequency));
    }
  }
  return LogLinearCurve({points.begin(), points.end()});
}

std::optional<double> LogLinearCurve::at(double frequency) const {
  if (!(frequency >= points_.front().frequency && frequency <= points_.back().frequency)) return std::nullopt;
  const auto above = std::lower_bound(points_.begin(), points_.end(), frequency,
                                      [](const CurvePoint& point, double f) { return point.frequency < f; });
  if (above == points_.begin()) return points_.front().value;
  const auto i = static_cast<std::size_t>(above - points_.begin());
  const double w = (frequency - points_[i - 1].frequency) / (points_[i].frequency - points_[i - 1].frequency);
  return std::exp(logs_[i - 1] + w * (logs_[i] - logs_[i - 1]));
}

std::optional<double> LogLinearCurve::highest_frequency_at(double value) const {
  const double wanted = std::log(value);
  if (logs_.back() <= wanted) return points_.back().frequency;
  for (std::size_t i = points_.size() - 1; i-- > 0;) {
    if (!(logs_[i] <= wanted)) continue;
    const double w = (wanted - logs_[i]) / (logs_[i + 1] - logs_[i]);
    return points_[i].frequency + w * (points_[i + 1].frequency - points_[i].frequency);
  }
  return std::nullopt;
}

double LogLinearCurve::root_excess_integral(double value) const {
  const double wanted = std::log(value);
  double sum = 0;
  for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
    double a = (wanted - logs_[i]) / 2, b = (wanted - logs_[i + 1]) / 2;
    double length = points_[i + 1].frequency - points_[i].frequency;
    if (a <= 0 && b <= 0) continue;
    // The part of the piece in which the curve lies below.
    if (a < 0) {
      length *= b / (b - a);
      a = 0;
    } else if (b < 0) {
      length *= a / (a - b);
      b = 0;
    }
    sum += length * mean_exponential(a, b);
  }
  return sum;
}

}  // namespace todbench
