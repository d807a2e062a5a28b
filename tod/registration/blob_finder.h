// SPDX-License-Identifier: GPL-3.0-or-later
// Compact warm spots in a picture: candidates for the triangles of a plate.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace todbench {

/// A compact spot that is warmer than its surround.
struct Blob {
  cv::Point2d centre;   ///< centre of mass above the background, accurate to about 0.3 px
  double size_px = 0;   ///< square root of the area above half of the height
  double strength = 0;  ///< height above the background, in the unit of the picture
};

/// Returns warm spots of `smallest_px` to `largest_px` (square root of area), the strongest first. Each spot is
/// delimited at half of its height, so a lamp in the picture does not hide a triangle. Variations of the background
/// over distances above about twice `largest_px` have no effect. To find cold spots, pass the negative picture.
[[nodiscard]] std::vector<Blob> find_warm_blobs(const cv::Mat1d& picture, double smallest_px, double largest_px);

}  // namespace todbench
