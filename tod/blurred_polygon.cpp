#include "tod/blurred_polygon.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

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

/// The flux through the side of the field whose divergence is the Gaussian round `at`:
/// F(v) = v / (2 pi |v|^2) (1 - exp(-|v|^2 / (2 blur^2))). Summed over all sides it is the blurred indicator (Gauss's
/// theorem).
double flux(const Side& s, double distance, double t0, double blur) {
  const double inverse = 1 / (2 * blur * blur);
  double sum = 0;
  for (std::size_t k = 0; k < s.nodes.size(); ++k) {
    const double t = t0 + s.nodes[k];
    const double r2 = distance * distance + t * t;
    const double z = r2 * inverse;
    // (1 - exp(-z)) / r2 tends to 1 / (2 blur^2) at the node itself; beyond z = 40 the exponential is below 1e-17.
    const double density = z < 1e-12 ? inverse : (z > 40 ? 1 / r2 : -std::expm1(-z) / r2);
    sum += s.weights[k] * density;
  }
  return distance * sum / (2 * std::numbers::pi);
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
  for (int row = 0; row < window.height; ++row) {
    for (int column = 0; column < window.width; ++column) {
      const cv::Point2d at(window.x + column, window.y + row);
      for (const Side& s : sides) {
        const cv::Point2d to_start = s.start - at;
        const double distance = to_start.dot(s.outward);
        const double t0 = to_start.dot(s.along);
        image.value(row, column) += flux(s, distance, t0, blur_px);
        const double edge = line_integral(s, distance, t0, blur_px);
        image.d_shift_x(row, column) += s.outward.x * edge;
        image.d_shift_y(row, column) += s.outward.y * edge;
      }
    }
  }
  return image;
}

}  // namespace todbench
