// The projective mapping of least squares.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <span>

namespace todbench {

/// The homography (lower right element 1) with the least sum of squared distances between `to` and the mapped `from`:
/// the normalised linear solution (Hartley 1997), improved by the method of Levenberg and Marquardt. Nothing for fewer
/// than four places, for places that fix no homography (on one line), and where one is mapped to infinity.
/// Precondition: as many `to` as `from`.
[[nodiscard]] std::optional<cv::Matx33d> fit_homography(std::span<const cv::Point2d> from,
                                                        std::span<const cv::Point2d> to);

}  // namespace todbench
