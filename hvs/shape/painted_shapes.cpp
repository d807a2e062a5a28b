// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/shape/painted_shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace todbench {
namespace {

/// Relative to the whole extent.
constexpr double smallest_feature = 1e-9;

double cross_of(cv::Point2d p, cv::Point2d q) {
  return p.x * q.y - p.y * q.x;
}

struct Extent {
  double left = 0, top = 0, right = 0, bottom = 0;
  [[nodiscard]] bool meets(const Extent& other, double margin) const {
    return left <= other.right + margin && other.left <= right + margin && top <= other.bottom + margin &&
           other.top <= bottom + margin;
  }
  [[nodiscard]] bool holds(cv::Point2d p) const { return p.x >= left && p.x <= right && p.y >= top && p.y <= bottom; }
};

Extent extent_of(cv::Point2d a, cv::Point2d b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::max(a.x, b.x), std::max(a.y, b.y)};
}

Extent extent_of(const Polygon& polygon) {
  Extent out = extent_of(polygon.front(), polygon.front());
  for (const auto& v : polygon) {
    out = {std::min(out.left, v.x), std::min(out.top, v.y), std::max(out.right, v.x), std::max(out.bottom, v.y)};
  }
  return out;
}

/// Whether the polygon contains p, by crossings of a ray to the right.
bool holds(const Polygon& polygon, cv::Point2d p) {
  bool inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const auto& a = polygon[i];
    const auto& b = polygon[(i + 1) % polygon.size()];
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)) inside = !inside;
  }
  return inside;
}

struct PaintedEdge {
  cv::Point2d a, b;
  std::size_t owner = 0;
  Extent extent;
  std::vector<double> cuts{0, 1};
};

/// Finds the cuts of the edge by another one: crossings and touching ends, as fractions of its length.
void cut(PaintedEdge& edge, const PaintedEdge& other, double smallest) {
  const cv::Point2d d = edge.b - edge.a, e = other.b - other.a;
  const double length = std::hypot(d.x, d.y);
  const auto add = [&](double share) {
    if (share > 0 && share < 1) edge.cuts.push_back(share);
  };
  for (const auto& end : {other.a, other.b}) {
    if (std::abs(cross_of(d, end - edge.a)) <= smallest * length) add((end - edge.a).dot(d) / (length * length));
  }
  const double turn = cross_of(d, e);
  if (std::abs(turn) <= 1e-12 * length * std::hypot(e.x, e.y)) return;
  const double at = cross_of(other.a - edge.a, e) / turn, of_other = cross_of(other.a - edge.a, d) / turn;
  if (of_other >= 0 && of_other <= 1) add(at);
}

class PaintedPicture {
 public:
  explicit PaintedPicture(std::span<const PaintedPolygon> painted) : painted_(painted) {
    for (const auto& p : painted) extents_.push_back(extent_of(p.outline));
  }

  /// Index of the topmost polygon at a place; empty: none.
  [[nodiscard]] std::optional<std::size_t> top_at(cv::Point2d place) const {
    for (std::size_t i = painted_.size(); i-- > 0;) {
      if (extents_[i].holds(place) && holds(painted_[i].outline, place)) return i;
    }
    return std::nullopt;
  }
  [[nodiscard]] double level(std::optional<std::size_t> top) const { return top ? painted_[*top].level : 0; }

 private:
  std::span<const PaintedPolygon> painted_;
  std::vector<Extent> extents_;
};

std::vector<PaintedEdge> edges_of(std::span<const PaintedPolygon> painted) {
  std::vector<PaintedEdge> edges;
  for (std::size_t p = 0; p < painted.size(); ++p) {
    const Polygon& outline = painted[p].outline;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const auto& a = outline[i];
      const auto& b = outline[(i + 1) % outline.size()];
      if (a != b) edges.push_back({.a = a, .b = b, .owner = p, .extent = extent_of(a, b)});
    }
  }
  return edges;
}

}  // namespace

bool is_simple(const Polygon& polygon) {
  const std::size_t n = polygon.size();
  if (n < 3) return false;
  for (const auto& v : polygon) {
    if (!std::isfinite(v.x) || !std::isfinite(v.y)) return false;
  }
  const auto side = [&](std::size_t i, cv::Point2d p) {
    return cross_of(polygon[(i + 1) % n] - polygon[i], p - polygon[i]);
  };
  for (std::size_t i = 0; i < n; ++i) {
    const Extent mine = extent_of(polygon[i], polygon[(i + 1) % n]);
    if (polygon[i] == polygon[(i + 1) % n]) return false;
    for (std::size_t j = i + 1; j < n; ++j) {
      const auto &c = polygon[j], &d = polygon[(j + 1) % n];
      const bool next = j == i + 1, before = (j + 1) % n == i;
      const double c_side = side(i, c), d_side = side(i, d);
      if (next || before) {
        // Neighbours share a vertex; they must not overlap.
        const auto &shared = next ? c : polygon[i], &own = next ? polygon[i] : polygon[(i + 1) % n],
                   &far = next ? d : c;
        if (cross_of(own - shared, far - shared) == 0 && (own - shared).dot(far - shared) > 0) return false;
        continue;
      }
      if (!mine.meets(extent_of(c, d), 0)) continue;
      const double a_side = side(j, polygon[i]), b_side = side(j, polygon[(i + 1) % n]);
      if ((c_side <= 0 || d_side <= 0) && (c_side >= 0 || d_side >= 0) && (a_side <= 0 || b_side <= 0) &&
          (a_side >= 0 || b_side >= 0))
        return false;
    }
  }
  return area(polygon) > 0;
}

std::vector<StepEdge> visible_edges(std::span<const PaintedPolygon> painted) {
  std::vector<PaintedEdge> edges = edges_of(painted);
  double whole = 0;
  for (const auto& edge : edges)
    whole = std::max({whole, std::abs(edge.a.x), std::abs(edge.a.y), std::abs(edge.b.x), std::abs(edge.b.y)});
  const double smallest = smallest_feature * whole;
  for (auto& edge : edges) {
    for (const auto& other : edges) {
      if (&edge != &other && edge.extent.meets(other.extent, smallest)) cut(edge, other, smallest);
    }
  }
  const PaintedPicture picture(painted);
  std::vector<StepEdge> visible;
  for (auto& edge : edges) {
    std::sort(edge.cuts.begin(), edge.cuts.end());
    const cv::Point2d d = edge.b - edge.a;
    const cv::Point2d aside = cv::Point2d(d.y, -d.x) * (smallest / std::hypot(d.x, d.y));
    for (std::size_t i = 0; i + 1 < edge.cuts.size(); ++i) {
      const double from = edge.cuts[i], to = edge.cuts[i + 1];
      if (to - from <= 1e-12) continue;
      const cv::Point2d middle = edge.a + d * ((from + to) / 2);
      const auto here = picture.top_at(middle + aside), there = picture.top_at(middle - aside);
      // The step belongs to the topmost polygon; another polygon's edge at the same place is not counted again.
      if (here == there || std::max(here, there) != std::optional(edge.owner)) continue;
      const double step = picture.level(here) - picture.level(there);
      if (step != 0) visible.push_back({edge.a + d * from, edge.a + d * to, step});
    }
  }
  return visible;
}

std::vector<StepEdge> element_edges(const cv::Mat1d& levels, double side, cv::Point2d corner) {
  const auto level = [&](int y, int x) {
    return x >= 0 && y >= 0 && x < levels.cols && y < levels.rows ? levels(y, x) : 0.0;
  };
  const auto node = [&](int y, int x) { return corner + side * cv::Point2d(x, y); };
  std::vector<StepEdge> edges;
  // Joins the steps along one line of the lattice: `step` and `place` of its parts and nodes.
  const auto add_line = [&](int parts, const auto& step, const auto& place) {
    for (int from = 0; from < parts;) {
      int to = from + 1;
      while (to < parts && step(to) == step(from)) ++to;
      if (step(from) != 0) edges.push_back({place(from), place(to), step(from)});
      from = to;
    }
  };
  for (int y = 0; y <= levels.rows; ++y)
    add_line(
        levels.cols, [&](int x) { return level(y - 1, x) - level(y, x); }, [&](int x) { return node(y, x); });
  for (int x = 0; x <= levels.cols; ++x)
    add_line(
        levels.rows, [&](int y) { return level(y, x) - level(y, x - 1); }, [&](int y) { return node(y, x); });
  return edges;
}

double integral(std::span<const StepEdge> edges) {
  double sum = 0;
  for (const auto& edge : edges) sum -= edge.step * (edge.a.x + edge.b.x) / 2 * (edge.b.y - edge.a.y);
  return sum;
}

std::vector<StepEdge> placed(std::span<const StepEdge> edges, double scale, double rotation_deg, cv::Point2d offset) {
  const double angle = rotation_deg * std::numbers::pi / 180;
  const double c = scale * std::cos(angle), s = scale * std::sin(angle);
  const auto moved = [&](cv::Point2d p) { return cv::Point2d(c * p.x - s * p.y, s * p.x + c * p.y) + offset; };
  std::vector<StepEdge> out;
  out.reserve(edges.size());
  for (const auto& edge : edges) out.push_back({moved(edge.a), moved(edge.b), edge.step});
  return out;
}

}  // namespace todbench
