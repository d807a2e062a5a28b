// SPDX-License-Identifier: GPL-3.0-or-later
// Pixels that a camera has replaced by values of their neighbours, so that frames do not contain their own signal.
#pragma once

#include <opencv2/core.hpp>
#include <span>

namespace todbench {

/// Limits of substituted pixels.
struct SubstitutionRules {
  double chance = 1e-3;       ///< probability, over all pixels, that a live pixel is classified as substituted
  double unit_per_count = 0;  ///< rounding of the frames; 0: not known
};

/// Result of substituted_pixels().
struct SubstitutedPixels {
  cv::Mat1b found;      ///< 255 for a substituted pixel
  bool tested = false;  ///< there were enough frames and a fine enough scale
};

/// Finds substituted pixels. `constant`: pixels that never change; they may equal each other without being copies.
/// Precondition: at least two frames, all of one size.
[[nodiscard]] SubstitutedPixels substituted_pixels(std::span<const cv::Mat1f> frames, const cv::Mat1b& constant,
                                                   const SubstitutionRules& rules);

}  // namespace todbench
