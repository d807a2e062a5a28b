// Where a plate without triangles is in a picture.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "hvs/shape/polygon.h"

namespace todbench {

/// The upright box of a polygon.
[[nodiscard]] cv::Rect2d box_of(const Polygon& polygon);

/// By how much cut-outs of these outlines (pixels, centres at whole numbers) lie beside them in the picture: whole
/// pixels, by normalised correlation, any sign of contrast. `calibration` where they are not in the picture; `plate` is
/// its name for the sentence.
[[nodiscard]] Result<cv::Point2d> plate_offset(const cv::Mat1d& picture, const std::vector<Polygon>& outlines,
                                               const std::string& plate);

}  // namespace todbench
