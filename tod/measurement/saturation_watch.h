// SPDX-License-Identifier: GPL-3.0-or-later
// Detection of clipped pixels: a target that is too hot or too cold for the camera.
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
  /// Learns from the average of a set-up with the observed contrast `contrast_k`. Returns the number of pixels of the
  /// triangles that were at an end in some of its frames, without the defective ones.
  ///
  /// The ends are 0 and full scale of the significant bits, or a count at which several pixels stayed in every frame
  /// while noise moved the others and none went beyond: the end of a temperature range, or of fewer bits than the
  /// format has. A pixel that was there in every frame is defective if it is outside the triangles, or if the triangles
  /// are far from that end; it is ignored until it changes.
  [[nodiscard]] int learn(const AveragedPicture& picture, const RadiometricScale& scale,
                          const TargetPlate& mounted_plate, const Registration& registration, double contrast_k);
  /// Number of pixels of the window at an end of the counts, without the defective ones.
  [[nodiscard]] int saturated_pixels(const Frame& frame, const cv::Rect& window) const;

 private:
  friend bool saturated(const AveragedPicture& picture);
  void learn_ends(const AveragedPicture& picture);
  [[nodiscard]] bool at_end(std::uint16_t count) const { return count <= low_end_ || count >= high_end_; }

  int low_end_ = 0, high_end_ = 65535;
  cv::Mat1b defective_;  ///< empty: not yet learnt
};

/// Whether more than one in a thousand pixels stay at an end of the counts in every frame. The ends are those of
/// SaturationWatch::learn().
[[nodiscard]] bool saturated(const AveragedPicture& picture);

}  // namespace todbench
