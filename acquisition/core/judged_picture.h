// SPDX-License-Identifier: GPL-3.0-or-later
// Output of processing stages after the camera. This picture is judged instead of the frame.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "acquisition/base/result.h"
#include "acquisition/core/frame.h"

namespace todbench {

/// The output of the processing stages for a frame, with a separate scale; judged instead of the counts of the frame.
struct JudgedPicture {
  cv::Mat1w counts;
  int samples_per_pixel = 1;      ///< along each axis
  cv::Point2d first_px = {0, 0};  ///< position of sample (0, 0), in pixels of the frame
  cv::Mat1b cut_off{};            ///< not 0: the output of the stages was outside the range of counts; empty: nowhere
  std::optional<cv::Point2d> scan_px{};  ///< displacement of the frame assumed by a stage; empty: none
  std::optional<Error> none{};           ///< reason why this frame has no picture and must not be judged
};

/// Returns the frame with its judged picture as counts.
[[nodiscard]] Frame as_judged(Frame frame);
/// Returns the samples per pixel and axis of the judged picture; 1 if samples are pixels.
[[nodiscard]] int judged_samples_per_pixel(const Frame& frame);
/// Converts a position in the frame, in pixels, to samples of the judged picture.
[[nodiscard]] cv::Point2d judged_place(const Frame& frame, cv::Point2d place_px);

}  // namespace todbench
