// SPDX-License-Identifier: GPL-3.0-or-later
// Least-squares projective mapping.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <span>

namespace todbench {

/// Returns the homography with the smallest sum of squared distances between `to` and the mapped `from`. The lower
/// right element is 1. The normalised linear solution (Hartley 1997) is improved by the method of Levenberg and
/// Marquardt. Empty with fewer than four points, if the points do not determine a homography (for example if they lie
/// on one line), or if a point is mapped to infinity. Precondition: `from` and `to` have the same number of points.
[[nodiscard]] std::optional<cv::Matx33d> fit_homography(std::span<const cv::Point2d> from,
                                                        std::span<const cv::Point2d> to);

}  // namespace todbench
