// Pixels that a camera has replaced by their neighbours: nothing of their own is in any frame.
#pragma once

#include <opencv2/core.hpp>
#include <span>

namespace todbench {

struct SubstitutionRules {
  double chance = 1e-3;       ///< of taking a live pixel for one, over all pixels together
  double unit_per_count = 0;  ///< rounding of the frames; 0: none is known
};

struct SubstitutedPixels {
  cv::Mat1b found;      ///< 255 where a pixel is one
  bool tested = false;  ///< enough frames and a scale fine enough to tell
};

/// `constant`: pixels that never change, which equal each other without being copies. Precondition: two frames or more
/// of one size.
[[nodiscard]] SubstitutedPixels substituted_pixels(std::span<const cv::Mat1f> frames, const cv::Mat1b& constant,
                                                   const SubstitutionRules& rules);

}  // namespace todbench
