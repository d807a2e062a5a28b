// SPDX-License-Identifier: GPL-3.0-or-later
// Detects, in the pictures of a camera, non-uniformity corrections that the camera does not report.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string_view>
#include <vector>

#include "acquisition/core/frame.h"

namespace todbench {

/// Evidence of a correction. During a correction the camera closes its shutter and repeats its last picture or shows
/// the shutter; afterwards its offsets differ.
enum class CorrectionSign {
  frozen_picture,  ///< several frames equal bit for bit
  shutter,         ///< a picture without structure in a scene with structure
  level_jump,      ///< every pixel moved by the same amount
  pattern_change,  ///< the fixed pattern changed: two successive frames differ by more than temporal noise
};
[[nodiscard]] std::string_view to_string(CorrectionSign sign);

/// Thresholds of CorrectionWatch.
struct CorrectionWatchOptions {
  /// Number of equal successive frames, the first included, that counts as a frozen picture.
  int frozen_frames = 3;
  /// Level jump, in units of the median difference of successive frames (1.01 standard deviations for white noise).
  double level_jump = 2;
  /// Ratio of the difference of two frames to the median difference. A change of the fixed pattern by f standard
  /// deviations of temporal noise gives sqrt(1 + f^2 / 2): 1.3 detects f = 1.2. With white noise and 5000 pixels, the
  /// ratio scatters by 1.2 %. If the noise is below 1.5 counts, changes below 2 counts are not detected.
  double pattern_ratio = 1.3;
  /// A picture is without structure if its range (1st to 99th percentile) is below this share of the largest observed
  /// range.
  double shutter_range_ratio = 0.5;
  /// Number of comparisons from which the median difference is computed. No sign is reported before this number is
  /// reached.
  int history = 15;
};

/// Compares every frame with the preceding frame, pixel by pixel, over about 5000 pixels. Differences are trimmed at
/// their 95th percentile, so that slightly moving edges and a few flickering pixels do not count as a correction. One
/// thread at a time.
class CorrectionWatch {
 public:
  explicit CorrectionWatch(CorrectionWatchOptions options) : options_(options) {}

  /// Returns the evidence of a correction in this frame, if any. The frame must be complete and show the same scene as
  /// the preceding frame.
  [[nodiscard]] std::optional<CorrectionSign> see(const Frame& frame);
  /// Returns the evidence of a correction, if any, for a frame that is bit-identical to the preceding frame.
  [[nodiscard]] std::optional<CorrectionSign> see_frozen();
  /// Announces a change of the scene: the next frame is not compared.
  void scene_changed();

 private:
  void remember(double spread, double range);

  CorrectionWatchOptions options_;
  std::vector<std::uint16_t> previous_;  ///< sampled pixels of the preceding frame; empty: no frame
  std::deque<double> differences_;       ///< trimmed mean differences of successive frames
  std::optional<double> usual_range_;    ///< largest range observed in this scene
  int equal_frames_ = 1;
};

}  // namespace todbench
