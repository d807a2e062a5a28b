// SPDX-License-Identifier: GPL-3.0-or-later
// Image of painted shapes behind a filter, from the exact spectrum of their edges.
#pragma once

#include <opencv2/core.hpp>
#include <span>

#include "hvs/shape/painted_shapes.h"
#include "hvs/shape/polygon_image.h"

namespace todbench {

/// Returns one period at `per_unit` points per unit length; point (j, i) is at (i, j) / per_unit, periodic. The edges
/// must be closed, as visible_edges() returns them, and near the origin. Equals the sum of PolygonImage::fine_image()
/// over polygons that add up to the same picture. Precondition: per_unit * period > 2 band.
[[nodiscard]] cv::Mat1d fine_step_image(std::span<const StepEdge> edges, const FilterTable& filter, int per_unit);

}  // namespace todbench
