// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes of uniform level painted over each other, represented by the edges at which the level steps.
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

/// A straight edge from a to b. `step` is the level on its side (dy, -dx) minus that on the other, (dx, dy) = b - a:
/// along the edge the gradient of the picture is step (dy, -dx).
struct StepEdge {
  cv::Point2d a, b;
  double step = 0;
};

/// Whether edges meet only at the vertices that they share, and the area is not 0. Needs at least three vertices, all
/// finite.
[[nodiscard]] bool is_simple(const Polygon& polygon);

/// Returns the visible edges of polygons painted in order over level 0. Edges are cut at crossings and contacts with
/// others; covered edges and edges with the same level on both sides are omitted; edges shared by two polygons count
/// once. Features below 1e-9 of the whole extent are lost. Cost: the square of the number of edges.
[[nodiscard]] std::vector<StepEdge> visible_edges(std::span<const PaintedPolygon> painted);

/// Returns the edges between the square elements of a picture, over level 0 outside. The corner of element (0, 0) lies
/// at `corner`; `side` is that of an element. Edges of one step that continue each other are joined.
[[nodiscard]] std::vector<StepEdge> element_edges(const cv::Mat1d& levels, double side, cv::Point2d corner);

/// Integral of the level over the plane.
[[nodiscard]] double integral(std::span<const StepEdge> edges);

/// Rotated clockwise (y points down) about the origin, scaled, then moved.
[[nodiscard]] std::vector<StepEdge> placed(std::span<const StepEdge> edges, double scale, double rotation_deg,
                                           cv::Point2d offset);

}  // namespace todbench
