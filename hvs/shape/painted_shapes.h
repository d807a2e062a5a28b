// Shapes of uniform level painted over each other, as what a picture of them is made of: the edges where the level
// steps.
#pragma once

#include <span>
#include <vector>

#include "hvs/shape/polygon.h"

namespace todbench {

/// A polygon that covers whatever was painted before it.
struct PaintedPolygon {
  Polygon outline;  ///< simple: see is_simple()
  double level = 0;
};

/// A straight edge from a to b. `step` is the level on its side (dy, -dx) minus that on the other, (dx, dy) = b - a:
/// the gradient of the picture is step (dy, -dx) along it.
struct StepEdge {
  cv::Point2d a, b;
  double step = 0;
};

/// Whether no edge meets another but at the vertex that they share, and the area is not 0. At least three vertices,
/// finite.
[[nodiscard]] bool is_simple(const Polygon& polygon);

/// The edges of what is seen when the polygons are painted in their order over level 0. Edges are cut where others
/// cross or touch them; what is covered, or has the same level on both sides, is left out; edges that two polygons
/// share count once. Features below 1e-9 of the whole extent are lost. Cost: the square of the number of edges.
[[nodiscard]] std::vector<StepEdge> visible_edges(std::span<const PaintedPolygon> painted);

/// The integral of the level over the plane.
[[nodiscard]] double integral(std::span<const StepEdge> edges);

/// Turned clockwise (y points down) about the origin, scaled, then moved.
[[nodiscard]] std::vector<StepEdge> placed(std::span<const StepEdge> edges, double scale, double rotation_deg,
                                           cv::Point2d offset);

}  // namespace todbench
