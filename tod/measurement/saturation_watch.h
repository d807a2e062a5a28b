// Pixels at an end of the counts: what is left of a target that is too hot or too cold for the camera.
#pragma once

#include <opencv2/core.hpp>

#include "tod/measurement/frame_taker.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

/// Knows where the counts of a camera end, and which pixels are there whatever they see. One thread at a time.
class SaturationWatch {
 public:
  /// Learns from the average of a set-up at a contrast of `contrast_k` as the camera sees it. Returns how many pixels
  /// of the triangles were at an end in some of its frames, those that always are left out.
  ///
  /// The ends are 0 and full scale of the significant bits, or a count at which several pixels stayed in every frame
  /// while noise moved the others and none went beyond: the end of a temperature range, or of fewer bits than the
  /// format has. A pixel that was there in every frame is defective where it sees no triangle, or where the triangles
  /// are far from that end; it does not count until it moves.
  [[nodiscard]] int learn(const AveragedPicture& picture, const RadiometricScale& scale,
                          const TargetPlate& mounted_plate, const Registration& registration, double contrast_k);
  /// Pixels of the window at an end of the counts that do not always read so.
  [[nodiscard]] int saturated_pixels(const Frame& frame, const cv::Rect& window) const;

 private:
  void learn_ends(const AveragedPicture& picture);
  [[nodiscard]] bool at_end(std::uint16_t count) const { return count <= low_end_ || count >= high_end_; }

  int low_end_ = 0, high_end_ = 65535;
  cv::Mat1b defective_;  ///< empty: nothing learnt
};

}  // namespace todbench
