// The mapping from located centroids: as simple as they allow.
#pragma once

#include <opencv2/core.hpp>
#include <span>

#include "tod/registration/registration.h"

namespace todbench {

/// A mapping with the error it leaves.
struct FittedMapping {
  cv::Matx33d plate_to_pixel = cv::Matx33d::eye();
  PlateMapping mapping = PlateMapping::similarity;
  double residual_px = 0;  ///< rms distance
};

/// Similarity (4 parameters) by least squares; affine (6) or homography (8) where the sum of squares falls by more than
/// chance explains (F test at 1 %), at least two triangles beyond the necessary ones are there, and they do not lie
/// along one line. One place: translation at `default_scale`.
[[nodiscard]] FittedMapping fit_mapping(std::span<const cv::Point2d> plate_mm, std::span<const cv::Point2d> pixels,
                                        double default_scale);

}  // namespace todbench
