// SPDX-License-Identifier: GPL-3.0-or-later
// Detects clipped pixels. Pixels are clipped if the target is too hot or too cold for the camera.
#pragma once

#include <opencv2/core.hpp>

#include "tod/measurement/frame_taker.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

/// Determines the lowest and the highest count of a camera, and the defective pixels that always have one of these two
/// counts. One thread at a time.
class SaturationWatch {
 public:
  /// Updates the two counts and the defective pixels from the average of a set-up with the observed contrast
  /// `contrast_k`. Returns the number of triangle pixels that had the lowest or the highest count in at least one
  /// frame, without defective pixels.
  ///
  /// The initial values are 0 and the full scale of the significant bits. A count becomes the new lowest or highest
  /// count if several pixels had it in every frame, all other pixels varied with noise, and no pixel was beyond it. It
  /// is then the limit of a temperature range, or of a camera with fewer bits than the format. A pixel that had the
  /// lowest or the highest count in every frame is defective if it is outside the triangles, or if the levels of the
  /// triangles are far from this count. A defective pixel is ignored until it changes.
  [[nodiscard]] int learn(const AveragedPicture& picture, const RadiometricScale& scale,
                          const TargetPlate& mounted_plate, const Registration& registration, double contrast_k);
  /// Returns the number of pixels in the window at the lowest or the highest count, without defective pixels.
  [[nodiscard]] int saturated_pixels(const Frame& frame, const cv::Rect& window) const;

 private:
  friend bool saturated(const AveragedPicture& picture);
  void learn_ends(const AveragedPicture& picture);
  [[nodiscard]] bool at_end(std::uint16_t count) const { return count <= low_end_ || count >= high_end_; }

  int low_end_ = 0, high_end_ = 65535;
  cv::Mat1b defective_;  ///< empty: not yet determined
};

/// Returns whether more than one pixel in a thousand has the lowest or the highest count in every frame. The two counts
/// are determined as in SaturationWatch::learn().
[[nodiscard]] bool saturated(const AveragedPicture& picture);

}  // namespace todbench
