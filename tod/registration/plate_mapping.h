// SPDX-License-Identifier: GPL-3.0-or-later
// Fits the simplest mapping that describes the located centroids.
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

/// Returns the least-squares similarity (4 parameters). Returns an affine mapping (6 parameters) or a homography (8
/// parameters) instead if three conditions are met: the decrease of the sum of squares is significant (F test at 1 %);
/// there are at least two triangles more than necessary; the triangles do not lie along one line. With one position,
/// the mapping is a translation at the expected scale. Similarity and residual are computed in a picture with square
/// pixels (y multiplied by `pixel_aspect`).
[[nodiscard]] FittedMapping fit_mapping(std::span<const cv::Point2d> plate_mm, std::span<const cv::Point2d> pixels,
                                        const RegistrationOptions& options);
/// Converts a mapping from millimetres to pixels of this aspect into a mapping to square pixels. with_own_pixels() is
/// the inverse function.
[[nodiscard]] cv::Matx33d with_square_pixels(const cv::Matx33d& mapping, double pixel_aspect);
[[nodiscard]] cv::Matx33d with_own_pixels(const cv::Matx33d& mapping, double pixel_aspect);

}  // namespace todbench
