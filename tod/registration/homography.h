// SPDX-License-Identifier: GPL-3.0-or-later
// Least-squares projective mapping.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <span>

namespace todbench {

/// Returns the homography (lower right element 1) with the smallest sum of squared distances between `to` and the
/// mapped `from`. It is the normalised linear solution (Hartley 1997), improved by the method of Levenberg and
/// Marquardt. Empty with fewer than four points, if the points do not determine a homography (on one line), or if one
/// is mapped to infinity. Precondition: as many `to` as `from`.
[[nodiscard]] std::optional<cv::Matx33d> fit_homography(std::span<const cv::Point2d> from,
                                                        std::span<const cv::Point2d> to);

}  // namespace todbench
