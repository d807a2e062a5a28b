// SPDX-License-Identifier: GPL-3.0-or-later
// Location of a plate without triangles in a picture.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "hvs/shape/polygon.h"

namespace todbench {

/// Returns the upright bounding box of a polygon.
[[nodiscard]] cv::Rect2d box_of(const Polygon& polygon);

/// Returns the offset of the cut-outs in the picture relative to `outlines`, in whole pixels. Outlines are in pixels,
/// with pixel centres at integers. Uses normalised correlation with any sign of contrast. `plate`: name of the plate
/// for the message. Error: `calibration` (the plate is not in the picture).
[[nodiscard]] Result<cv::Point2d> plate_offset(const cv::Mat1d& picture, const std::vector<Polygon>& outlines,
                                               const std::string& plate);

}  // namespace todbench
