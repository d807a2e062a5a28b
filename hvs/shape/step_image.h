// SPDX-License-Identifier: GPL-3.0-or-later
// Image of painted shapes after a filter, computed from the exact spectrum of the edges.
#pragma once

#include <opencv2/core.hpp>
#include <span>

#include "hvs/shape/painted_shapes.h"
#include "hvs/shape/polygon_image.h"

namespace todbench {

/// Returns one period of the filtered picture at `per_unit` points per unit length; element (j, i) is the point
/// (i, j) / per_unit. The result equals the sum of PolygonImage::fine_image() over polygons that add up to the picture.
/// Preconditions: the edges are near the origin and form closed outlines, as returned by visible_edges(); per_unit is
/// above 2 * band / period, with band and period of `filter`.
[[nodiscard]] cv::Mat1d fine_step_image(std::span<const StepEdge> edges, const FilterTable& filter, int per_unit);

}  // namespace todbench
