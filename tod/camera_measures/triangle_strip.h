// The smallest triangles of a plate as a camera saw them, side by side.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

struct TriangleStrip {
  double set_delta_t_k = 0;
  int frames = 0;               ///< averaged
  std::vector<double> size_px;  ///< square root of the area, from left to right
  cv::Mat1d kelvin;             ///< windows of one size, two columns of the largest value between them
};

/// Windows round the `count` smallest triangles of a plate, smallest first, from a mean picture in kelvin: as large as
/// the largest of them needs, 16 pixels at least. What lies beyond the picture has its median. Precondition: the plate
/// has a triangle.
[[nodiscard]] TriangleStrip smallest_triangles(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                               const Registration& where, int count);

}  // namespace todbench
