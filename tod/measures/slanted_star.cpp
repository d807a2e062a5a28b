// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/slanted_star.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "acquisition/base/try.h"

namespace todbench {
namespace {

constexpr double radians_per_degree = std::numbers::pi / 180;
/// Distance of a region from other edges and from the border of the star. slanted_edge() demands as much of its edge.
constexpr double margin_px = 5;

double value_at(const cv::Mat1d& picture, cv::Point2d at) {
  const int x = std::min(static_cast<int>(at.x), picture.cols - 2),
            y = std::min(static_cast<int>(at.y), picture.rows - 2);
  const double u = at.x - x, v = at.y - y;
  return (1 - v) * ((1 - u) * picture(y, x) + u * picture(y, x + 1)) +
         v * ((1 - u) * picture(y + 1, x) + u * picture(y + 1, x + 1));
}

/// Mean along the radius, for angles from 0 to 360 degrees.
std::vector<double> ring_of(const cv::Mat1d& picture, const StarPlace& star) {
  const double inner = 0.45 * star.radius_px, outer = 0.85 * star.radius_px;
  const auto angles = static_cast<std::size_t>(std::ceil(4 * 2 * std::numbers::pi * outer));
  const int radii = static_cast<int>(outer - inner) + 1;
  std::vector<double> ring(angles);
  for (std::size_t i = 0; i < angles; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(angles);
    const cv::Point2d along(std::cos(angle), std::sin(angle));
    for (int r = 0; r < radii; ++r) ring[i] += value_at(picture, star.centre_px + (inner + r) * along) / radii;
  }
  return ring;
}

/// Angles at which a ring crosses the level between its bright and its dark sectors.
std::vector<double> crossings_of(const std::vector<double>& ring) {
  std::vector<double> sorted = ring;
  std::ranges::sort(sorted);
  const double dark = sorted[sorted.size() / 10], bright = sorted[sorted.size() - 1 - sorted.size() / 10];
  const double level = 0.5 * (dark + bright), near = 0.25 * (bright - dark);
  const std::size_t n = ring.size();
  // Begins where the ring is surely on one side. A change of side counts once the ring has passed the level by a half
  // of the way to the plateau, so that noise at the level makes no edges.
  std::size_t begin = 0;
  while (begin < n && std::abs(ring[begin] - level) < near) ++begin;
  std::vector<double> found;
  if (begin == n || !(near > 0)) return found;
  bool above = ring[begin] > level;
  double last = 0;
  for (std::size_t step = 1; step <= n; ++step) {
    const double before = ring[(begin + step - 1) % n] - level, now = ring[(begin + step) % n] - level;
    if ((before > 0) != (now > 0)) last = static_cast<double>(begin + step - 1) + before / (before - now);
    if (std::abs(now) < near || (now > 0) == above) continue;
    above = now > 0;
    found.push_back(std::fmod(360 * last / static_cast<double>(n), 360));
  }
  std::ranges::sort(found);
  return found;
}

/// Angle from one direction to the next in the sense of the angles, 0 to 360 degrees.
double turn(double from_deg, double to_deg) {
  return std::fmod(to_deg - from_deg + 720, 360);
}

/// Whether a point, seen from the centre, is in the sectors beside an edge, away from the neighbours and the border.
bool is_beside(cv::Point2d at, double radius_px, double before_deg, double after_deg) {
  const double r = std::hypot(at.x, at.y);
  if (r > radius_px - margin_px) return false;
  const auto far = [&](double edge_deg, double sign) {
    const cv::Point2d along(std::cos(edge_deg * radians_per_degree), std::sin(edge_deg * radians_per_degree));
    return sign * (along.x * at.y - along.y * at.x) >= margin_px || along.dot(at) < -margin_px;
  };
  const double angle = std::atan2(at.y, at.x) / radians_per_degree;
  return turn(before_deg, angle) < turn(before_deg, after_deg) && far(before_deg, 1) && far(after_deg, -1);
}

/// The largest region of an edge: from `near` to `far` radii along it, and `width` to both sides. Empty: none.
std::optional<cv::Rect> region_of(const StarPlace& star, double edge_deg, double before_deg, double after_deg) {
  const cv::Point2d along(std::cos(edge_deg * radians_per_degree), std::sin(edge_deg * radians_per_degree));
  const bool upright = std::abs(along.y) >= std::abs(along.x);
  std::optional<cv::Rect> best;
  double most = 0;
  for (double near = 0.15; near < 0.7; near += 0.05) {
    for (double far = near + 0.2; far < 0.97; far += 0.05) {
      const cv::Point2d a = near * star.radius_px * along, b = far * star.radius_px * along;
      for (int width = 8; width < star.radius_px; ++width) {
        const cv::Point2d beside = upright ? cv::Point2d(width, 0) : cv::Point2d(0, width);
        const double left = std::min(a.x, b.x) - beside.x, right = std::max(a.x, b.x) + beside.x;
        const double top = std::min(a.y, b.y) - beside.y, bottom = std::max(a.y, b.y) + beside.y;
        bool free = true;
        for (const cv::Point2d corner : {cv::Point2d(left, top), {right, top}, {left, bottom}, {right, bottom}})
          free = free && is_beside(corner, star.radius_px, before_deg, after_deg);
        if (!free) break;
        const double lines = upright ? bottom - top : right - left;
        // Beyond 30 pixels the sides carry little more than the level.
        const double worth = lines * std::min(width, 30);
        if (worth <= most || lines < 8) continue;
        most = worth;
        const cv::Point2d c = star.centre_px;
        best = cv::Rect(cv::Point(static_cast<int>(std::ceil(c.x + left)), static_cast<int>(std::ceil(c.y + top))),
                        cv::Point(static_cast<int>(c.x + right) + 1, static_cast<int>(c.y + bottom) + 1));
      }
    }
  }
  return best;
}

StarDirection direction_of(double normal_deg, cv::Point2d from_middle, double radius_px) {
  if (std::hypot(from_middle.x, from_middle.y) < radius_px) return StarDirection::central;
  const double apart = std::fmod(normal_deg - std::atan2(from_middle.y, from_middle.x) / radians_per_degree + 720, 180);
  const double from_line = std::min(apart, 180 - apart);
  if (from_line <= 22.5) return StarDirection::tangential;
  return from_line >= 67.5 ? StarDirection::sagittal : StarDirection::oblique;
}

Result<void> check(const cv::Mat1d& picture, const StarPlace& star) {
  constexpr double least_radius = 30;
  if (!(star.radius_px >= least_radius))
    return fail(ErrorCode::invalid_input, fmt::format("the radius of a star is at least {} pixels", least_radius));
  const cv::Point2d c = star.centre_px;
  const double r = star.radius_px;
  if (!(c.x - r >= 0) || !(c.y - r >= 0) || !(c.x + r <= picture.cols - 1) || !(c.y + r <= picture.rows - 1))
    return fail(ErrorCode::invalid_input,
                fmt::format("the star extends beyond the picture of {} x {} pixels", picture.cols, picture.rows));
  return {};
}

Result<void> check(const std::vector<double>& edges_deg) {
  constexpr double least_deg = 15;
  if (edges_deg.size() < 4 || edges_deg.size() % 2 != 0)
    return fail(ErrorCode::invalid_input,
                fmt::format("a circle about the stated centre crosses {} edges, expected an even number of at least 4: "
                            "state the centre and the radius of the star",
                            edges_deg.size()));
  for (std::size_t i = 0; i < edges_deg.size(); ++i) {
    const double apart = turn(edges_deg[i], edges_deg[(i + 1) % edges_deg.size()]);
    if (apart < least_deg)
      return fail(ErrorCode::invalid_input, fmt::format("two edges of the star are {:.1f} degrees apart, expected at "
                                                        "least {} degrees",
                                                        apart, least_deg));
  }
  return {};
}

}  // namespace

std::string_view to_string(StarDirection direction) {
  constexpr std::array<std::string_view, 4> words{"tangential", "sagittal", "oblique", "central"};
  return words[static_cast<std::size_t>(direction)];
}

Result<std::vector<StarEdge>> slanted_star(const cv::Mat1d& picture, const StarPlace& star,
                                           const SlantedEdgeOptions& options) {
  TODBENCH_TRY_VOID(check(picture, star));
  const std::vector<double> edges_deg = crossings_of(ring_of(picture, star));
  TODBENCH_TRY_VOID(check(edges_deg));
  const cv::Point2d from_middle = star.centre_px - 0.5 * cv::Point2d(picture.cols - 1, picture.rows - 1);
  std::vector<StarEdge> edges;
  const std::size_t n = edges_deg.size();
  for (std::size_t i = 0; i < n; ++i) {
    StarEdge edge{.edge_deg = edges_deg[i], .normal_deg = std::fmod(edges_deg[i] + 90, 180)};
    const auto region = region_of(star, edge.edge_deg, edges_deg[(i + n - 1) % n], edges_deg[(i + 1) % n]);
    if (!region) {
      edge.rejected = "there is too little room between its neighbours";
    } else {
      edge.region = *region;
      SlantedEdgeOptions own = options;
      own.axis =
          std::abs(std::sin(edge.edge_deg * radians_per_degree)) >= std::numbers::sqrt2 / 2 ? EdgeAxis::x : EdgeAxis::y;
      auto measured = slanted_edge(picture(*region).clone(), own);
      if (measured) {
        edge.normal_deg =
            std::fmod((own.axis == EdgeAxis::x ? measured->angle_deg : 90 - measured->angle_deg) + 180, 180);
        edge.measured = *std::move(measured);
      } else {
        edge.rejected = measured.error().message;
      }
    }
    edge.direction = direction_of(edge.normal_deg, from_middle, star.radius_px);
    edges.push_back(std::move(edge));
  }
  if (std::ranges::none_of(edges, [](const StarEdge& edge) { return edge.measured.has_value(); }))
    return fail(ErrorCode::invalid_input,
                "no edge of the star could be measured; the first: " + edges.front().rejected);
  return edges;
}

}  // namespace todbench
