// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/ramp_forecast.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/core.hpp>

namespace todbench {
namespace {

/// Information and ratio of a contrast over u, in ln.
using LnInformation = std::map<double, cv::Vec2d>;

cv::Vec2d between(const LnInformation& nodes, double u) {
  const auto above = nodes.lower_bound(u);
  if (above == nodes.begin()) return above->second;
  const auto below = std::prev(above);
  if (above == nodes.end()) return below->second;
  const double share = (u - below->first) / (above->first - below->first);
  return (1 - share) * below->second + share * above->second;
}

/// Powers of u of the stretch; those that the fit does not take are 0 (RampFit::of()).
cv::Vec3d powers_of(double u, double span_u) {
  constexpr double constant_below = 0.05, straight_below = 0.3;
  return {1, span_u < constant_below ? 0 : u, span_u < straight_below ? 0 : u * u};
}

}  // namespace

std::vector<double> equal_presentations(std::span<const ContrastInformation> points, std::span<const double> shown_k,
                                        const ContrastNoise& noise) {
  LnInformation nodes;
  for (const ContrastInformation& point : points)
    nodes[contrast_bend(noise, point.delta_t_k)] = {std::log(point.information), std::log(point.variance_ratio)};
  std::vector<double> u;
  for (const double delta_t_k : shown_k) u.push_back(contrast_bend(noise, delta_t_k));
  const auto [least, most] = std::ranges::minmax_element(u);
  const double span_u = *most - *least;
  cv::Matx33d information = cv::Matx33d::zeros(), scatter = cv::Matx33d::zeros();
  for (const double one : u) {
    const cv::Vec2d ln = between(nodes, one);
    const cv::Vec3d powers = powers_of(one, span_u);
    information += std::exp(ln[0]) * (powers * powers.t());
    scatter += std::exp(ln[0] + ln[1]) * (powers * powers.t());
  }
  for (int k = 0; k < 3; ++k)
    if (information(k, k) == 0) information(k, k) = 1;
  const cv::Matx33d inverse = information.inv();
  std::vector<double> out;
  for (const ContrastInformation& point : points) {
    const cv::Vec3d row = inverse * powers_of(contrast_bend(noise, point.delta_t_k), span_u);
    const double variance = row.dot(scatter * row), of_one = point.variance_ratio / point.information;
    out.push_back(variance > 0 ? std::clamp(of_one / variance, 1.0, static_cast<double>(shown_k.size())) : 1.0);
  }
  return out;
}

std::vector<int> nearest_presentations(std::span<const double> points_k, std::span<const double> shown_k) {
  std::vector<int> out(points_k.size(), 0);
  for (const double shown : shown_k) {
    const auto nearest = std::ranges::min_element(
        points_k, {}, [&](double point) { return std::abs(std::log(std::abs(point / shown))); });
    if (nearest != points_k.end()) ++out[static_cast<std::size_t>(nearest - points_k.begin())];
  }
  return out;
}

}  // namespace todbench
