// SPDX-License-Identifier: GPL-3.0-or-later
// Computes the exact area of each pixel that a polygon covers.
#pragma once

#include <opencv2/core.hpp>

#include "hvs/shape/polygon.h"

namespace todbench {

/// Returns the share of each pixel inside the polygon; pixel (column i, row j) extends from (i, j) to (i + 1, j + 1).
/// Every edge is cut at the grid lines, and the area is computed in closed form. The error due to rounding is about
/// 1e-12 of a pixel. The polygon may extend beyond the picture. The computing time is proportional to the number of
/// pixels plus the number of pixels along the edges.
[[nodiscard]] cv::Mat1d pixel_coverage(const Polygon& polygon, cv::Size size);

}  // namespace todbench
