// Noise of a sequence of frames by direction: time, rows, columns and all of their combinations.
#pragma once

#include <opencv2/core.hpp>
#include <span>

#include "acquisition/core/result.h"

namespace todbench {

/// Standard deviations of the seven components of D'Agostino and Webb (1991), in the unit of the frames. t: time,
/// v: vertical (constant along a row), h: horizontal (constant along a column). Estimated without bias for any number
/// of frames, rows and columns by the analysis of variance; a variance that comes out negative is 0.
struct ThreeDNoise {
  double tvh = 0;  ///< pixels in time: what is left
  double tv = 0;   ///< rows that flicker
  double th = 0;   ///< columns that flicker
  double t = 0;    ///< whole frames
  double vh = 0;   ///< fixed pattern, and the scene where there is one
  double v = 0;    ///< fixed rows
  double h = 0;    ///< fixed columns
  /// Temporal noise of a pixel: the root of the sum of the four squares with t.
  [[nodiscard]] double temporal() const;
};

/// `invalid_input`: fewer than two frames, rows or columns, or frames of different sizes.
[[nodiscard]] Result<ThreeDNoise> three_d_noise(std::span<const cv::Mat1f> frames);

}  // namespace todbench
