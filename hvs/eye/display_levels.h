// SPDX-License-Identifier: GPL-3.0-or-later
// The 256 levels of a display, for pictures of known luminance contrast.
#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "hvs/eye/viewed_display.h"

namespace todbench {

/// Luminance contrast of every level to the background, which is in the middle of the luminance range, veil included.
/// Rising.
using LevelContrasts = std::array<double, 256>;
/// Computes the contrasts.
[[nodiscard]] LevelContrasts level_contrasts(const ViewedDisplay& display);

/// The level below a contrast, the share of the way to the next one, and the distance of both.
struct BetweenLevels {
  int below = 0;
  double share = 0, step = 0;
};
/// Finds the two levels round a contrast.
[[nodiscard]] BetweenLevels between_levels(const LevelContrasts& contrasts, double contrast);

/// A picture as the operator of a thermal camera sees it. `kelvin`: displayed samples above the background;
/// `contrast_k`: contrast of the target. With the gain of the operator a target has the luminance contrast of the
/// display's key `contrast`; with a fixed gain (span_k) the level is linear in kelvin. Samples are enlarged to `zoom`
/// pixels by the interpolation of the display. Values beyond black and white are clipped.
[[nodiscard]] cv::Mat1b operator_picture(const ViewedDisplay& display, const cv::Mat1d& kelvin, double contrast_k);

/// Level of the background, nearest to the middle of the luminances.
[[nodiscard]] int background_level_of(const ViewedDisplay& display);

}  // namespace todbench
