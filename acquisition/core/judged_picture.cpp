// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/judged_picture.h"

namespace todbench {

Frame as_judged(Frame frame) {
  if (frame.judged != nullptr) frame.counts = frame.judged->counts;
  return frame;
}

int judged_samples_per_pixel(const Frame& frame) {
  return frame.judged == nullptr ? 1 : frame.judged->samples_per_pixel;
}

cv::Point2d judged_place(const Frame& frame, cv::Point2d place_px) {
  if (frame.judged == nullptr) return place_px;
  return (place_px - frame.judged->first_px) * frame.judged->samples_per_pixel;
}

}  // namespace todbench
