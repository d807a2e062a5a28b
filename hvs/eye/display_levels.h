// SPDX-License-Identifier: GPL-3.0-or-later
// The 256 levels of a display, for pictures of known luminance contrast.
#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "hvs/eye/viewed_display.h"

namespace todbench {

/// Luminance contrasts of all levels relative to the background, in increasing order. The background is in the middle
/// of the luminance range. The contrasts include the veil (ambient light that the display reflects).
using LevelContrasts = std::array<double, 256>;
/// Returns the luminance contrasts of all levels of a display.
[[nodiscard]] LevelContrasts level_contrasts(const ViewedDisplay& display);

/// Position of a contrast between two levels.
struct BetweenLevels {
  /// Index of the lower level.
  int below = 0;
  /// Position between the lower level (0) and the next level (1), and the contrast difference of these two levels.
  double share = 0, step = 0;
};
/// Finds the two levels on either side of a contrast.
[[nodiscard]] BetweenLevels between_levels(const LevelContrasts& contrasts, double contrast);

/// Returns the picture that the operator of a thermal camera sees. `kelvin`: displayed samples relative to the
/// background; `contrast_k`: contrast of the target. If the operator sets the gain, the target has the luminance
/// contrast stated by the display's key `contrast`. With a fixed gain (span_k) the level is linear in kelvin. Samples
/// are enlarged to `zoom` pixels by the interpolation of the display. Values beyond black and white are clipped.
[[nodiscard]] cv::Mat1b operator_picture(const ViewedDisplay& display, const cv::Mat1d& kelvin, double contrast_k);

/// Returns the level of the background. It is the level nearest to the middle of the luminance range.
[[nodiscard]] int background_level_of(const ViewedDisplay& display);

}  // namespace todbench
