// How much of each pixel a polygon covers: exact areas.
#pragma once

#include <opencv2/core.hpp>

#include "hvs/shape/polygon.h"

namespace todbench {

/// The share of each pixel that lies within the polygon; pixel (column i, row j) reaches from (i, j) to (i + 1, j + 1).
/// Every edge is cut at the lines of the grid and its area added up in closed form: exact to rounding (about 1e-12 of a
/// pixel). The polygon may leave the picture. Cost: the pixels plus those along the edges.
[[nodiscard]] cv::Mat1d pixel_coverage(const Polygon& polygon, cv::Size size);

}  // namespace todbench
