// SPDX-License-Identifier: GPL-3.0-or-later
// Tails of the MTF from the whole picture of a plate with cut-outs.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "hvs/shape/polygon.h"
#include "tod/measures/slanted_edge.h"

namespace todbench {

/// Fits the tails (edge_tails.h) to the pixels that are nearest to cut-out `which`. These are the pixels inside the
/// cut-out and on the plate round the cut-out, except for the core of every edge. The shading is modelled as a plane
/// inside the cut-out and as a polynomial of second order outside. The position of the cut-out is first refined by a
/// fraction of a pixel.
///
/// `cut_outs`: outlines of four corners in pixels; `plate`: the part of the picture that the plate covers. Empty if too
/// few pixels remain.
[[nodiscard]] std::optional<PlateTails> plate_tails(const cv::Mat1d& picture, const std::vector<Polygon>& cut_outs,
                                                    std::size_t which, const cv::Rect2d& plate,
                                                    const TailBounds& bounds);

/// Returns `tails` for a part of the picture. `origin`: position of the upper left pixel of this part in the whole
/// picture.
[[nodiscard]] PlateTails moved_to(const PlateTails& tails, cv::Point origin);

}  // namespace todbench
