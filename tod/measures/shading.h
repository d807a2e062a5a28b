// SPDX-License-Identifier: GPL-3.0-or-later
// Smooth variation across a flat field that is caused by optics, shutter and housing, not by the pixels.
#pragma once

#include <opencv2/core.hpp>

namespace todbench {

/// A surface of second order that is fitted to a picture by least squares.
struct Shading {
  cv::Mat1d surface;  ///< fitted surface minus its mean
  double range = 0;   ///< largest minus smallest value
  double sd = 0;      ///< standard deviation over the pixels
};

/// Fits the surface. Precondition: at least three rows and columns, finite.
[[nodiscard]] Shading shading_of(const cv::Mat1d& picture);

}  // namespace todbench
