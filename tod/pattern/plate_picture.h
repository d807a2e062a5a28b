// SPDX-License-Identifier: GPL-3.0-or-later
// Draws a plate as a picture for a display. The level of a pixel is computed from the exact area that cut-outs cover.
#pragma once

#include <opencv2/core.hpp>

#include "acquisition/base/result.h"
#include "tod/plate/target_plate.h"

namespace todbench {

/// Pixels of a display.
struct DisplayGeometry {
  cv::Size size_px;
  double pixel_mm = 1;  ///< distance between the centres of neighbouring pixels, equal along x and y
};

/// Draws a plate with the level `pattern` inside triangles and rectangles and `ground` elsewhere. The level of a pixel
/// is the mean over the area of the pixel. The plate's origin is the middle of the display, moved by `shift_mm` (x
/// right, y down). Errors: `invalid_input` (a cut-out outside the display, a level outside 0 to 1, a display without
/// pixels).
[[nodiscard]] Result<cv::Mat1d> plate_picture(const TargetPlate& mounted_plate, cv::Point2d shift_mm,
                                              const DisplayGeometry& display, double ground, double pattern);

}  // namespace todbench
