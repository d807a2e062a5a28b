// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/registration/blurred_polygon.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "acquisition/base/multiversion.h"

namespace todbench {
namespace {

/// One side of the polygon with the nodes and weights of its quadrature.
struct Side {
  cv::Point2d start, along, outward;  ///< unit vectors
  double length = 0;
  std::vector<double> nodes, weights;
};

/// Gauss-Legendre with three nodes on panels of at most 1.2 blur widths: the integrand is smooth on the scale of the
/// blur.
Side side(cv::Point2d start, cv::Point2d end, double orientation, double blur) {
  constexpr double gauss_node = 0.7745966692414834;
  constexpr std::array<double, 3> node{-gauss_node, 0, gauss_node};
  constexpr std::array<double, 3> weight{5.0 / 9, 8.0 / 9, 5.0 / 9};
  const cv::Point2d edge = end - start;
  Side s;
  s.start = start;
  s.length = std::hypot(edge.x, edge.y);
  if (s.length == 0) return s;
  s.along = edge / s.length;
  s.outward = orientation * cv::Point2d(s.along.y, -s.along.x);
  const int panels = static_cast<int>(std::ceil(s.length / (1.2 * blur)));
  const double half = s.length / panels / 2;
  for (int i = 0; i < panels; ++i) {
    for (std::size_t k = 0; k < node.size(); ++k) {
      s.nodes.push_back(half * (2 * i + 1 + node[k]));
      s.weights.push_back(half * weight[k]);
    }
  }
  return s;
}

double signed_area(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) twice += polygon[i].cross(polygon[(i + 1) % polygon.size()]);
  return twice / 2;
}

/// 1 - exp(-z) for 0 <= z, relative error below 1e-15: exp(-z) = 2^-n exp(-r) with |r| <= ln(2) / 2 and the series of
/// exp(-r) - 1. Plain arithmetic, so that a loop over it vectorises and every compiler gives the same bits.
inline double one_minus_exp(double z) {
  constexpr double ln2_high = 0x1.62e42fefa3800p-1;  // 42 bits: a multiple of it is exact
  constexpr double ln2_low = 0x1.ef35793c76730p-45;
  constexpr double round_to_whole = 0x1.8p52;  // adding it leaves the whole number in the last bits
  const double capped = z < 64 ? z : 64;       // exp(-64) is below half a unit in the last place of 1
  const double shifted = capped * std::numbers::log2e + round_to_whole;
  const double n = shifted - round_to_whole;
  const double r = (n * ln2_high - capped) + n * ln2_low;
  double p = 1.0 / 6227020800;
  for (const double factorial :
       {479001600.0, 39916800.0, 3628800.0, 362880.0, 40320.0, 5040.0, 720.0, 120.0, 24.0, 6.0, 2.0, 1.0}) {
    p = p * r + 1 / factorial;
  }
  const double expm1_r = p * r;
  const std::int64_t exponent =
      1023 - (std::bit_cast<std::int64_t>(shifted) - std::bit_cast<std::int64_t>(round_to_whole));
  const double power = std::bit_cast<double>(exponent << 52);
  return (1 - power) - power * expm1_r;
}

/// Adds the contribution of one node of a side to every pixel, given the pixel's distance from the side's line and from
/// its start along it. It is the flux through the side of the field whose divergence is the Gaussian round the pixel:
/// F(v) = v / (2 pi |v|^2) (1 - exp(-|v|^2 / (2 blur^2))). The sum over all sides is the blurred indicator (Gauss's
/// theorem).
TODBENCH_MULTIVERSION
void add_node(const double* distance, const double* start, std::size_t count, double node, double weight,
              double inverse, double* __restrict sums) {
  for (std::size_t i = 0; i < count; ++i) {
    const double t = start[i] + node;
    const double r2 = distance[i] * distance[i] + t * t;
    const double z = r2 * inverse;
    // (1 - exp(-z)) / r2 tends to 1 / (2 blur^2) at the node itself.
    const bool at_node = z < 1e-12;
    const double quotient = one_minus_exp(z) / (at_node ? 1.0 : r2);
    sums[i] += weight * (at_node ? inverse : quotient);
  }
}

/// The pixel with this number when a window is read row by row.
cv::Point place_in(cv::Rect window, std::size_t index) {
  const int i = static_cast<int>(index);
  return window.tl() + cv::Point(i % window.width, i / window.width);
}

/// Integral of the Gaussian along the side.
double line_integral(const Side& s, double distance, double t0, double blur) {
  const double root2 = std::numbers::sqrt2 * blur;
  const double across = std::exp(-distance * distance / (2 * blur * blur)) / (blur * std::sqrt(2 * std::numbers::pi));
  return across * 0.5 * (std::erf((t0 + s.length) / root2) - std::erf(t0 / root2));
}

}  // namespace

BlurredPolygon blurred_polygon(const Polygon& polygon, double blur_px, cv::Rect window) {
  // x right, y down: with this sign the normal (dy, -dx) of a side points outwards for either sense of rotation.
  const double orientation = signed_area(polygon) >= 0 ? 1 : -1;
  std::vector<Side> sides;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    sides.push_back(side(polygon[i], polygon[(i + 1) % polygon.size()], orientation, blur_px));
  }
  BlurredPolygon image{cv::Mat1d::zeros(window.size()), cv::Mat1d::zeros(window.size()),
                       cv::Mat1d::zeros(window.size())};
  const auto count = static_cast<std::size_t>(window.area());
  std::vector<double> distance(count), start(count), sums(count);
  const double inverse = 1 / (2 * blur_px * blur_px);
  for (const Side& s : sides) {
    for (std::size_t i = 0; i < count; ++i) {
      const cv::Point2d to_start = s.start - cv::Point2d(place_in(window, i));
      distance[i] = to_start.dot(s.outward);
      start[i] = to_start.dot(s.along);
    }
    std::fill(sums.begin(), sums.end(), 0.0);
    for (std::size_t k = 0; k < s.nodes.size(); ++k)
      add_node(distance.data(), start.data(), count, s.nodes[k], s.weights[k], inverse, sums.data());
    for (std::size_t i = 0; i < count; ++i) {
      const cv::Point at = place_in(window, i) - window.tl();
      const double edge = line_integral(s, distance[i], start[i], blur_px);
      image.value(at) += distance[i] * sums[i] / (2 * std::numbers::pi);
      image.d_shift_x(at) += s.outward.x * edge;
      image.d_shift_y(at) += s.outward.y * edge;
    }
  }
  return image;
}

}  // namespace todbench
