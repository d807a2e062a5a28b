// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/separated_pattern.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "acquisition/base/try.h"

namespace todbench {
namespace {

/// The unknowns, or a right side of the same shape.
struct Unknowns {
  cv::Mat1d camera, source;
  std::vector<double> levels;

  [[nodiscard]] double dot(const Unknowns& other) const {
    return camera.dot(other.camera) + source.dot(other.source) +
           std::inner_product(levels.begin(), levels.end(), other.levels.begin(), 0.0);
  }
  void add(double factor, const Unknowns& other) {
    cv::scaleAdd(other.camera, factor, camera, camera);
    cv::scaleAdd(other.source, factor, source, source);
    for (std::size_t k = 0; k < levels.size(); ++k) levels[k] += factor * other.levels[k];
  }
};

/// Part of the source that a picture shows. A source shifted to the right shows its left part.
struct Layout {
  cv::Size size, whole;
  std::vector<cv::Rect> windows;

  explicit Layout(std::span<const ShiftedPicture> pictures) : size(pictures.front().picture.size()) {
    cv::Point least = pictures.front().shift_px, most = least;
    for (const ShiftedPicture& one : pictures) {
      least = {std::min(least.x, one.shift_px.x), std::min(least.y, one.shift_px.y)};
      most = {std::max(most.x, one.shift_px.x), std::max(most.y, one.shift_px.y)};
    }
    whole = size + cv::Size(most - least);
    for (const ShiftedPicture& one : pictures) windows.emplace_back(most - one.shift_px, size);
  }
  [[nodiscard]] Unknowns zeros() const {
    return {cv::Mat1d::zeros(size), cv::Mat1d::zeros(whole), std::vector<double>(windows.size())};
  }
  [[nodiscard]] cv::Mat1d picture(const Unknowns& of, std::size_t k) const {
    cv::Mat1d sum = of.camera + of.source(windows[k]);
    return cv::Mat1d(sum + of.levels[k]);
  }
  /// Adds the transpose of picture().
  void spread(const cv::Mat1d& picture, std::size_t k, Unknowns& to) const {
    to.camera += picture;
    cv::Mat1d part = to.source(windows[k]);
    part += picture;
    to.levels[k] += cv::sum(picture)[0];
  }
};

/// Removes the plane by least squares and returns its slope per pixel. Centred coordinates are orthogonal.
cv::Point2d without_plane(cv::Mat1d& of) {
  const double x0 = 0.5 * (of.cols - 1), y0 = 0.5 * (of.rows - 1);
  double xy[2] = {0, 0}, squares[2] = {0, 0};
  for (int j = 0; j < of.rows; ++j) {
    for (int i = 0; i < of.cols; ++i) {
      xy[0] += (i - x0) * of(j, i), squares[0] += (i - x0) * (i - x0);
      xy[1] += (j - y0) * of(j, i), squares[1] += (j - y0) * (j - y0);
    }
  }
  const cv::Point2d slope(xy[0] / squares[0], xy[1] / squares[1]);
  const double mean = cv::mean(of)[0];
  for (int j = 0; j < of.rows; ++j) {
    for (int i = 0; i < of.cols; ++i) of(j, i) -= mean + slope.x * (i - x0) + slope.y * (j - y0);
  }
  return slope;
}

/// Greatest common divisor of the areas that pairs of shifts span: 1 if they generate every shift by whole pixels.
std::int64_t common_area(std::span<const ShiftedPicture> pictures) {
  std::int64_t divisor = 0;
  for (const ShiftedPicture& a : pictures) {
    for (const ShiftedPicture& b : pictures) {
      const cv::Point from = pictures.front().shift_px, u = a.shift_px - from, v = b.shift_px - from;
      divisor = std::gcd(divisor, static_cast<std::int64_t>(u.x) * v.y - static_cast<std::int64_t>(u.y) * v.x);
    }
  }
  return divisor;
}

Result<void> check(std::span<const ShiftedPicture> pictures) {
  constexpr std::size_t least = 3;
  if (pictures.size() < least) return fail(ErrorCode::invalid_input, "fewer than three shifted pictures");
  for (const ShiftedPicture& one : pictures) {
    if (one.picture.size() != pictures.front().picture.size() || one.picture.rows < 2 || one.picture.cols < 2)
      return fail(ErrorCode::invalid_input, "the shifted pictures differ in size");
    if (!cv::checkRange(one.picture)) return fail(ErrorCode::invalid_input, "a shifted picture is not finite");
  }
  if (common_area(pictures) != 1)
    return fail(ErrorCode::invalid_input,
                "the shifts do not determine the patterns: they must span both axes without a common divisor");
  return {};
}

}  // namespace

Result<SeparatedPattern> separated_pattern(std::span<const ShiftedPicture> pictures) {
  TODBENCH_TRY_VOID(check(pictures));
  const Layout layout(pictures);
  Unknowns found = layout.zeros(), residual = layout.zeros();
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    const cv::Mat1d& picture = pictures[k].picture;
    found.levels[k] = cv::mean(picture)[0];
    layout.spread(cv::Mat1d(picture - found.levels[k]), k, residual);
  }
  // Conjugate gradients from patterns of 0 keep the undetermined constants and slopes small.
  constexpr int most_rounds = 1000;
  constexpr double enough = 1e-18;
  Unknowns direction{residual.camera.clone(), residual.source.clone(), residual.levels};
  double rest = residual.dot(residual);
  const double begin = rest;
  for (int round = 0; round < most_rounds && rest > enough * begin; ++round) {
    Unknowns applied = layout.zeros();
    for (std::size_t k = 0; k < pictures.size(); ++k) layout.spread(layout.picture(direction, k), k, applied);
    const double step = rest / direction.dot(applied);
    found.add(step, direction);
    residual.add(-step, applied);
    const double next = residual.dot(residual);
    direction.camera *= next / rest, direction.source *= next / rest;
    for (double& level : direction.levels) level *= next / rest;
    direction.add(1, residual);
    rest = next;
  }
  double squares = 0;
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    const cv::Mat1d off = pictures[k].picture - layout.picture(found, k);
    squares += off.dot(off);
  }
  SeparatedPattern out{.camera = found.camera, .source = found.source};
  out.residual = std::sqrt(squares / static_cast<double>(pictures.size()) / layout.size.area());
  out.slope_per_px = without_plane(out.camera);
  out.slope_per_px += without_plane(out.source);
  return out;
}

}  // namespace todbench
