// Sees in the pictures that a camera corrected its non-uniformity without saying so.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string_view>
#include <vector>

#include "acquisition/core/frame.h"

namespace todbench {

/// What of a correction was seen. The camera closes its shutter, repeats its last picture meanwhile or shows the
/// shutter, and comes back with other offsets.
enum class CorrectionSign {
  frozen_picture,  ///< several frames equal bit for bit
  shutter,         ///< a picture without structure where there was some
  level_jump,      ///< every pixel moved by the same amount
  pattern_change,  ///< the fixed pattern is another one: two successive frames differ by more than temporal noise
};
[[nodiscard]] std::string_view to_string(CorrectionSign sign);

struct CorrectionWatchOptions {
  /// Equal frames in succession, the first included, that count as a shutter.
  int frozen_frames = 3;
  /// In units of the usual difference of successive frames, which for white noise is 1.01 of its standard deviation.
  double level_jump = 2;
  /// Ratio of the difference of two frames to the usual one. A change of the fixed pattern by f standard deviations of
  /// temporal noise gives sqrt(1 + f^2 / 2): 1.3 sees f = 1.2. White noise scatters by 1.2 % (5000 pixels). Where the
  /// noise is below 1.5 counts, changes below 2 counts are not seen.
  double pattern_ratio = 1.3;
  /// A picture is without structure when its range (1st to 99th percentile) shrank to this share of the usual one.
  double shutter_range_ratio = 0.5;
  /// Comparisons needed before anything is said, and remembered: the usual value is their median.
  int history = 15;
};

/// Compares every frame with the one before it, pixel by pixel, over about 5000 pixels. Differences are trimmed at
/// their 95th percentile, so that edges that move a little, or a few flickering pixels, are no correction. One thread
/// at a time.
class CorrectionWatch {
 public:
  explicit CorrectionWatch(CorrectionWatchOptions options) : options_(options) {}

  /// A frame that is complete and shows the same scene as the one before it. What is seen in it, if anything.
  [[nodiscard]] std::optional<CorrectionSign> see(const Frame& frame);
  /// A frame that is bit-identical to the one before it.
  [[nodiscard]] std::optional<CorrectionSign> see_frozen();
  /// The scene is another one: the next frame is compared with nothing.
  void scene_changed();

 private:
  void remember(double spread, double range);

  CorrectionWatchOptions options_;
  std::vector<std::uint16_t> previous_;  ///< sampled pixels of the frame before; empty: none
  std::deque<double> differences_;       ///< trimmed mean differences of successive frames
  std::optional<double> usual_range_;    ///< of this scene, the largest so far
  int equal_frames_ = 1;
};

}  // namespace todbench
