// SPDX-License-Identifier: GPL-3.0-or-later
// Substituted pixels: a camera has replaced their signal by values of their neighbours.
#pragma once

#include <opencv2/core.hpp>
#include <span>

namespace todbench {

/// Limits of the test for substituted pixels.
struct SubstitutionRules {
  double chance = 1e-3;       ///< probability that at least one live pixel of the picture is classified as substituted
  double unit_per_count = 0;  ///< step of rounding in the frames, in their unit; 0: not known
};

/// Result of substituted_pixels().
struct SubstitutedPixels {
  cv::Mat1b found;      ///< 255 for a substituted pixel
  bool tested = false;  ///< true: the test was possible, because there are enough frames and the scale is fine enough
};

/// Finds substituted pixels. `constant`: pixels that never change. These pixels may be equal without being copies.
/// Precondition: at least two frames, all of one size.
[[nodiscard]] SubstitutedPixels substituted_pixels(std::span<const cv::Mat1f> frames, const cv::Mat1b& constant,
                                                   const SubstitutionRules& rules);

}  // namespace todbench
