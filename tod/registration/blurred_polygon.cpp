// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/registration/blurred_polygon.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "acquisition/base/normal.h"
#include "hvs/shape/gauss_legendre.h"

namespace todbench {
namespace {

/// A line along x through the polygon: the places where it crosses the sides, in ascending order, and its share of the
/// integral over y.
struct Slice {
  double y = 0, weight = 0;
  std::vector<double> crossings;
};

/// One side, from the end with the smaller y to the other one.
struct Side {
  cv::Point2d low, high;
};

std::vector<Side> sides_of(const Polygon& polygon) {
  std::vector<Side> sides;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    Side side{polygon[i], polygon[(i + 1) % polygon.size()]};
    if (side.low.y > side.high.y) std::swap(side.low, side.high);
    if (side.low.y < side.high.y) sides.push_back(side);
  }
  return sides;
}

/// Adds the slices between two successive heights of corners. Gauss-Legendre with three nodes on panels in which no
/// side is longer than one blur width: the integrand is smooth on the scale of the blur along every side.
void add_slices(const std::vector<Side>& sides, double from, double to, double blur, std::vector<Slice>& slices) {
  static const std::vector<QuadratureNode> rule = gauss_legendre(3);
  std::vector<Side> crossed;
  double longest = 0;
  for (const Side& side : sides) {
    if (!(side.low.y <= from && side.high.y >= to)) continue;
    crossed.push_back(side);
    longest = std::max(longest, cv::norm(side.high - side.low) / (side.high.y - side.low.y) * (to - from));
  }
  const int panels = std::max(1, static_cast<int>(std::ceil(longest / blur)));
  const double half = (to - from) / panels / 2;
  for (int panel = 0; panel < panels; ++panel) {
    for (const QuadratureNode& node : rule) {
      Slice slice{from + half * (2 * panel + 1 + node.x), half * node.weight, {}};
      for (const auto& [low, high] : crossed)
        slice.crossings.push_back(low.x + (slice.y - low.y) / (high.y - low.y) * (high.x - low.x));
      std::sort(slice.crossings.begin(), slice.crossings.end());
      slices.push_back(std::move(slice));
    }
  }
}

std::vector<Slice> slices_of(const Polygon& polygon, double blur) {
  const std::vector<Side> sides = sides_of(polygon);
  std::vector<double> heights;
  for (const cv::Point2d& corner : polygon) heights.push_back(corner.y);
  std::sort(heights.begin(), heights.end());
  std::vector<Slice> slices;
  for (std::size_t i = 1; i < heights.size(); ++i) {
    if (heights[i] > heights[i - 1]) add_slices(sides, heights[i - 1], heights[i], blur, slices);
  }
  return slices;
}

/// In units of the blur; beyond it the normal law is 0 or 1 to 1e-10.
constexpr double farthest = 6.5;

/// The pixels from `first` to below `last`, of `count` from `origin` on, that lie within `farthest` of a place.
struct Near {
  int first = 0, last = 0;
};
Near near(double place, double blur, int origin, int count) {
  const double reach = farthest * blur;
  return {static_cast<int>(std::clamp(std::ceil(place - reach - origin), 0.0, static_cast<double>(count))),
          static_cast<int>(std::clamp(std::floor(place + reach - origin) + 1, 0.0, static_cast<double>(count)))};
}

/// The blurred slice along x, and its change when it moves by 1 px.
struct Profile {
  std::vector<double> value, d_shift;
};

void blur_slice(const Slice& slice, double blur, cv::Rect window, Profile& profile) {
  std::fill(profile.value.begin(), profile.value.end(), 0.0);
  std::fill(profile.d_shift.begin(), profile.d_shift.end(), 0.0);
  double sign = -1;
  for (const double crossing : slice.crossings) {
    const auto [first, last] = near(crossing, blur, window.x, window.width);
    for (int i = 0; i < first; ++i) profile.value[static_cast<std::size_t>(i)] += sign;
    for (int i = first; i < last; ++i) {
      const double u = (crossing - (window.x + i)) / blur;
      profile.value[static_cast<std::size_t>(i)] += sign * normal_probability(u);
      profile.d_shift[static_cast<std::size_t>(i)] += sign * normal_density(u) / blur;
    }
    sign = -sign;
  }
}

void add_scaled(double factor, const std::vector<double>& numbers, double* sums) {
  for (std::size_t i = 0; i < numbers.size(); ++i) sums[i] += factor * numbers[i];
}

}  // namespace

BlurredPolygon blurred_polygon(const Polygon& polygon, double blur_px, cv::Rect window) {
  BlurredPolygon image{cv::Mat1d::zeros(window.size()), cv::Mat1d::zeros(window.size()),
                       cv::Mat1d::zeros(window.size())};
  const auto width = static_cast<std::size_t>(window.width);
  Profile profile{std::vector<double>(width), std::vector<double>(width)};
  // The Gaussian is a product: along x it blurs each slice to a profile, along y it spreads the profile over the rows.
  for (const Slice& slice : slices_of(polygon, blur_px)) {
    blur_slice(slice, blur_px, window, profile);
    const auto [first, last] = near(slice.y, blur_px, window.y, window.height);
    for (int row = first; row < last; ++row) {
      const double u = (slice.y - (window.y + row)) / blur_px;
      const double share = slice.weight * normal_density(u) / blur_px;
      add_scaled(share, profile.value, image.value[row]);
      add_scaled(share, profile.d_shift, image.d_shift_x[row]);
      add_scaled(-share * u / blur_px, profile.value, image.d_shift_y[row]);
    }
  }
  return image;
}

}  // namespace todbench
