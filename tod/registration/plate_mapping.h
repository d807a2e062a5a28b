// SPDX-License-Identifier: GPL-3.0-or-later
// The simplest adequate mapping of located centroids.
#pragma once

#include <opencv2/core.hpp>
#include <span>

#include "tod/registration/registration.h"

namespace todbench {

/// A mapping with its residual.
struct FittedMapping {
  cv::Matx33d plate_to_pixel = cv::Matx33d::eye();
  PlateMapping mapping = PlateMapping::similarity;
  double residual_px = 0;  ///< rms distance
};

/// Returns the least-squares similarity (4 parameters). Uses an affine mapping (6) or a homography (8) if three
/// conditions hold: the sum of squares decreases by more than chance explains (F test at 1 %), there are at least two
/// triangles more than necessary, and they do not lie along one line. With one position: translation at the expected
/// scale. The similarity and the residual refer to a picture with square pixels: y times `pixel_aspect`.
[[nodiscard]] FittedMapping fit_mapping(std::span<const cv::Point2d> plate_mm, std::span<const cv::Point2d> pixels,
                                        const RegistrationOptions& options);
/// Converts a mapping to pixels of this aspect into a mapping to square pixels. with_own_pixels() converts it back.
[[nodiscard]] cv::Matx33d with_square_pixels(const cv::Matx33d& mapping, double pixel_aspect);
[[nodiscard]] cv::Matx33d with_own_pixels(const cv::Matx33d& mapping, double pixel_aspect);

}  // namespace todbench
