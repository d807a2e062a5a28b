// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes of uniform level that are painted over each other, represented by the edges at which the level changes.
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "hvs/shape/polygon.h"

namespace todbench {

/// A polygon that covers everything painted before it.
struct PaintedPolygon {
  Polygon outline;  ///< simple: see is_simple()
  double level = 0;
};

/// A straight edge from a to b. With (dx, dy) = b - a, `step` is the level on the side (dy, -dx) minus the level on the
/// other side: along the edge the gradient of the picture is step (dy, -dx).
struct StepEdge {
  cv::Point2d a, b;
  double step = 0;
};

/// Returns whether edges meet only at shared vertices and the area is not 0. Returns false with fewer than three
/// vertices, or if a coordinate is not finite.
[[nodiscard]] bool is_simple(const Polygon& polygon);

/// Returns the visible edges of polygons that are painted in order over level 0. Edges that cross or touch each other
/// are cut at this point. Covered edges, and edges with the same level on both sides, are omitted. An edge shared by
/// two polygons is returned once. Features below 1e-9 of the whole extent are lost. The computing time grows with the
/// square of the number of edges.
[[nodiscard]] std::vector<StepEdge> visible_edges(std::span<const PaintedPolygon> painted);

/// Returns the edges between the square elements of a picture. The level outside the picture is 0. `corner`: corner of
/// element (0, 0); `side`: side of an element. Collinear neighbouring edges with the same step are joined.
[[nodiscard]] std::vector<StepEdge> element_edges(const cv::Mat1d& levels, double side, cv::Point2d corner);

/// Returns the integral of the level over the plane.
[[nodiscard]] double integral(std::span<const StepEdge> edges);

/// Returns the edges rotated clockwise (y points down) about the origin, then scaled, then moved.
[[nodiscard]] std::vector<StepEdge> placed(std::span<const StepEdge> edges, double scale, double rotation_deg,
                                           cv::Point2d offset);

}  // namespace todbench
