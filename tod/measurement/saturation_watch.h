// SPDX-License-Identifier: GPL-3.0-or-later
// Detects clipped pixels: the target is too hot or too cold for the camera.
#pragma once

#include <opencv2/core.hpp>

#include "tod/measurement/frame_taker.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

/// Learns the ends of a camera's range of counts, and the defective pixels that are always at an end. One thread at a
/// time.
class SaturationWatch {
 public:
  /// Learns from the average of a set-up with the observed contrast `contrast_k`. Returns the number of triangle pixels
  /// that were at an end in at least one frame, without the defective pixels.
  ///
  /// The ends are 0 and full scale of the significant bits. A count is also an end if several pixels stayed at it in
  /// every frame, while noise changed the others and no pixel exceeded it; this is the end of a temperature range, or
  /// of fewer bits than the format has. A pixel that was at an end in every frame is defective if it is outside the
  /// triangles, or if the triangles are far from that end. It is ignored until it changes.
  [[nodiscard]] int learn(const AveragedPicture& picture, const RadiometricScale& scale,
                          const TargetPlate& mounted_plate, const Registration& registration, double contrast_k);
  /// Returns the number of pixels of the window at an end of the counts, without the defective ones.
  [[nodiscard]] int saturated_pixels(const Frame& frame, const cv::Rect& window) const;

 private:
  friend bool saturated(const AveragedPicture& picture);
  void learn_ends(const AveragedPicture& picture);
  [[nodiscard]] bool at_end(std::uint16_t count) const { return count <= low_end_ || count >= high_end_; }

  int low_end_ = 0, high_end_ = 65535;
  cv::Mat1b defective_;  ///< empty: not yet learnt
};

/// Returns whether more than one in a thousand pixels stay at an end of the counts in every frame. The ends are those
/// of SaturationWatch::learn().
[[nodiscard]] bool saturated(const AveragedPicture& picture);

}  // namespace todbench
