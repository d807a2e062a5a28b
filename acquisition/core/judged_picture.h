// What is judged in a frame where stages stand behind the camera.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "acquisition/core/frame.h"
#include "acquisition/core/result.h"

namespace todbench {

/// What stages behind the camera made of a frame, on its scale: what an observer judges in place of the counts.
struct JudgedPicture {
  cv::Mat1w counts;
  int samples_per_pixel = 1;      ///< along each axis
  cv::Point2d first_px = {0, 0};  ///< where sample (0, 0) is, in pixels of the frame
  std::optional<Error> none{};    ///< why there is no picture of this frame, which nobody may judge then
};

/// The frame with what is judged in it as its counts.
[[nodiscard]] Frame as_judged(Frame frame);
/// Samples per pixel and axis of what is judged; 1: the pixels.
[[nodiscard]] int judged_samples_per_pixel(const Frame& frame);
/// A place of the frame, in pixels, as one of what is judged, in its samples.
[[nodiscard]] cv::Point2d judged_place(const Frame& frame, cv::Point2d place_px);

}  // namespace todbench
