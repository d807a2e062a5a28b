// SPDX-License-Identifier: GPL-3.0-or-later
// The smallest triangles of a plate as the camera shows them, side by side.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

/// Windows of triangles, side by side.
struct TriangleStrip {
  double set_delta_t_k = 0;
  int frames = 0;               ///< number of averaged frames
  std::vector<double> size_px;  ///< square root of the area, from left to right
  cv::Mat1d kelvin;             ///< windows of one size, separated by two columns of the largest value
};

/// Returns windows round the `count` smallest triangles of a plate, smallest first, from a mean picture in kelvin. All
/// windows have the same side, at least 16 pixels; the largest of these triangles determines it. Pixels outside the
/// picture are set to the median of the picture. Precondition: the plate has a triangle.
[[nodiscard]] TriangleStrip smallest_triangles(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                               const Registration& where, int count);

}  // namespace todbench
