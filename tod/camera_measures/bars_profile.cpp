// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/camera_measures/bars_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace todbench {
namespace {

constexpr double line_reach = 4;
constexpr double smoothing = 1e-6;  // of the mean diagonal

/// The integral of the cubic B-spline over [0, 4] up to v (de Boor 1978, truncated powers).
double spline_integral(double v) {
  if (v <= 0) return 0;
  if (v >= 4) return 1;
  constexpr std::array weights{1.0, -4.0, 6.0, -4.0};
  double sum = 0;
  for (std::size_t i = 0; i < weights.size() && v > static_cast<double>(i); ++i) {
    const double square = std::pow(v - static_cast<double>(i), 2);
    sum += weights[i] * square * square;
  }
  return sum / 24;
}

/// Rising and falling edges of the bars: at (2 i - 7) / 2 widths from the middle.
constexpr int edges = 8;
double edge_place(int edge, double width) {
  return (edge - 3.5) * width;
}
double edge_sign(int edge) {
  return edge % 2 == 0 ? 1 : -1;
}

int spline_count(double step) {
  return static_cast<int>(std::ceil(2 * line_reach / step));
}

}  // namespace

BarsProfile::BarsProfile(double first_knot, double step, double bar_width, double middle, double ground,
                         std::vector<double> coefficients)
    : first_knot_(first_knot),
      step_(step),
      width_(bar_width),
      middle_(middle),
      ground_(ground),
      coefficients_(std::move(coefficients)),
      sums_(coefficients_.size() + 1, 0.0) {
  for (std::size_t i = 0; i < coefficients_.size(); ++i) sums_[i + 1] = sums_[i] + coefficients_[i];
}

double BarsProfile::edge(double place) const {
  const double at = (place - first_knot_) / step_;
  const int cell = static_cast<int>(std::floor(at)), count = static_cast<int>(coefficients_.size());
  if (cell < 0) return 0;
  const int whole = std::min(std::max(cell - 3, 0), count);  // splines entirely to the left of the place
  double sum = sums_[static_cast<std::size_t>(whole)];
  for (int i = whole; i <= std::min(cell, count - 1); ++i)
    sum += coefficients_[static_cast<std::size_t>(i)] * spline_integral(at - i);
  return sum;
}

double BarsProfile::value(double place) const {
  double sum = ground_;
  for (int k = 0; k < edges; ++k) sum += edge_sign(k) * edge(place - middle_ - edge_place(k, width_));
  return sum;
}

std::optional<BarsFit> BarsFit::of(const std::vector<double>& places, double bar_width, double middle,
                                   double knot_step) {
  BarsFit fit;
  const int splines = spline_count(knot_step), unknowns = splines + 1;
  fit.step_ = knot_step, fit.width_ = bar_width, fit.middle_ = middle;
  fit.first_knot_ = -0.5 * (splines + 3) * knot_step;
  const int rows = static_cast<int>(places.size());
  if (rows <= unknowns) return std::nullopt;
  cv::Mat1d design(rows, unknowns, 0.0);
  for (int row = 0; row < rows; ++row) {
    design(row, 0) = 1;
    for (int k = 0; k < edges; ++k) {
      const double at =
          (places[static_cast<std::size_t>(row)] - middle - edge_place(k, bar_width) - fit.first_knot_) / knot_step;
      for (int i = 0; i < splines; ++i) design(row, i + 1) += edge_sign(k) * spline_integral(at - i);
    }
  }
  cv::Mat1d normal = design.t() * design;
  const double weight = smoothing * cv::trace(normal)[0] / unknowns;
  constexpr std::array third{-1.0, 3.0, -3.0, 1.0};
  for (int k = 1; k + 3 < unknowns; ++k) {
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j)
        normal(k + i, k + j) += weight * third[static_cast<std::size_t>(i)] * third[static_cast<std::size_t>(j)];
    }
  }
  // Straight line spreads cost nothing above; outside the range of the samples they are pulled to 0.
  for (int k = 1; k < unknowns; ++k) normal(k, k) += 0.01 * weight;
  if (!cv::solve(normal, design.t(), fit.solution_, cv::DECOMP_CHOLESKY)) return std::nullopt;
  fit.freedom_ = rows - cv::trace(fit.solution_ * design)[0];
  if (!(fit.freedom_ >= 1)) return std::nullopt;
  return fit;
}

BarsProfile BarsFit::profile(const std::vector<double>& values) const {
  const cv::Mat1d column(static_cast<int>(values.size()), 1, const_cast<double*>(values.data()));
  const cv::Mat1d found = solution_ * column;
  std::vector<double> coefficients(found.begin() + 1, found.end());
  return {first_knot_, step_, width_, middle_, found(0, 0), std::move(coefficients)};
}

}  // namespace todbench
