// SPDX-License-Identifier: GPL-3.0-or-later
// Robust centre and spread of pictures.
#pragma once

#include <opencv2/core.hpp>

namespace todbench {

/// Returns the median over all pixels. For an even number of pixels it is the mean of the two middle values.
/// Precondition: not empty, no NaN.
[[nodiscard]] double median_of(const cv::Mat1d& picture);
/// Returns the median distance from the median.
[[nodiscard]] double median_deviation_of(const cv::Mat1d& picture);

}  // namespace todbench
