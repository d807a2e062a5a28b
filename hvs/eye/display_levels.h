// SPDX-License-Identifier: GPL-3.0-or-later
// The 256 levels of a display, for pictures of known luminance contrast.
#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "hvs/eye/viewed_display.h"

namespace todbench {

/// Luminance contrast of every level relative to the background, which is in the middle of the luminance range.
/// Includes the veil. In increasing order.
using LevelContrasts = std::array<double, 256>;
/// Returns the contrasts.
[[nodiscard]] LevelContrasts level_contrasts(const ViewedDisplay& display);

/// The level below a contrast, the fraction of the way to the next level, and the difference of contrast between both.
struct BetweenLevels {
  int below = 0;
  double share = 0, step = 0;
};
/// Finds the two levels on either side of a contrast.
[[nodiscard]] BetweenLevels between_levels(const LevelContrasts& contrasts, double contrast);

/// Returns the picture that the operator of a thermal camera sees. `kelvin`: displayed samples relative to the
/// background; `contrast_k`: contrast of the target. If the operator sets the gain, the target has the luminance
/// contrast stated by the display's key `contrast`. With a fixed gain (span_k) the level is linear in kelvin. Samples
/// are enlarged to `zoom` pixels by the interpolation of the display. Values beyond black and white are clipped.
[[nodiscard]] cv::Mat1b operator_picture(const ViewedDisplay& display, const cv::Mat1d& kelvin, double contrast_k);

/// Returns the level of the background: the one nearest to the middle of the luminance range.
[[nodiscard]] int background_level_of(const ViewedDisplay& display);

}  // namespace todbench
