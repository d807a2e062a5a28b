// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/shape/polygon_coverage.h"

#include <algorithm>
#include <cmath>

namespace todbench {
namespace {

/// Green's theorem by pixels. An edge that runs down a pixel row by dy covers everything to its right by dy, and of the
/// pixel that it passes the part to its right. Edges left of the picture count in its first column; edges right of it
/// are ignored.
class Accumulator {
 public:
  explicit Accumulator(cv::Size size) : shares_(cv::Mat1d::zeros(size)), steps_(cv::Mat1d::zeros(size)) {}

  void add_edge(cv::Point2d a, cv::Point2d b) {
    if (a.y == b.y) return;
    const double sign = a.y < b.y ? 1 : -1;
    if (sign < 0) std::swap(a, b);
    const double slope = (b.x - a.x) / (b.y - a.y);
    const double top = std::max(a.y, 0.0), bottom = std::min(b.y, static_cast<double>(shares_.rows));
    for (int row = static_cast<int>(std::floor(top)); row < bottom; ++row) {
      const double y0 = std::max(top, static_cast<double>(row)), y1 = std::min(bottom, row + 1.0);
      if (y1 <= y0) continue;
      // From the nearer end, so that both ends are met exactly.
      const auto x_at = [&](double y) { return y - a.y < b.y - y ? a.x + slope * (y - a.y) : b.x - slope * (b.y - y); };
      add_in_row(row, x_at(y0), x_at(y1), sign * (y1 - y0));
    }
  }

  [[nodiscard]] cv::Mat1d shares() {
    for (int j = 0; j < shares_.rows; ++j) {
      double inside = 0;
      for (int i = 0; i < shares_.cols; ++i) {
        const double here = inside + shares_(j, i);
        inside += steps_(j, i);
        shares_(j, i) = std::clamp(std::abs(here), 0.0, 1.0);
      }
    }
    return shares_;
  }

 private:
  /// Adds a piece within one row, of signed height dy, between two positions in x.
  void add_in_row(int row, double x0, double x1, double dy) {
    if (x0 > x1) std::swap(x0, x1);
    const double width = shares_.cols;
    if (x1 <= 0) return add_to(row, 0, dy, 0);
    if (x0 >= width) return;
    if (x0 == x1) {
      const int column = static_cast<int>(std::floor(x0));
      return add_to(row, column, dy, x0 - column);
    }
    const double per_x = dy / (x1 - x0);
    if (x0 < 0) {
      add_to(row, 0, per_x * -x0, 0);
      x0 = 0;
    }
    const double end = std::min(x1, width);
    for (int column = static_cast<int>(std::floor(x0)); column < end; ++column) {
      const double left = std::max(x0, static_cast<double>(column)), right = std::min(end, column + 1.0);
      add_to(row, column, per_x * (right - left), (left + right) / 2 - column);
    }
  }
  /// Adds height dy at a mean position within the column, from its left edge.
  void add_to(int row, int column, double dy, double place) {
    if (column >= shares_.cols) return;
    shares_(row, column) += dy * (1 - place);
    steps_(row, column) += dy;
  }

  cv::Mat1d shares_, steps_;
};

}  // namespace

cv::Mat1d pixel_coverage(const Polygon& polygon, cv::Size size) {
  Accumulator sum(size);
  for (std::size_t i = 0; i < polygon.size(); ++i) sum.add_edge(polygon[i], polygon[(i + 1) % polygon.size()]);
  return sum.shares();
}

}  // namespace todbench
