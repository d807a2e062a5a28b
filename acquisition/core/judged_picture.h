// What is judged in a frame where stages stand behind the camera.
#pragma once

#include <opencv2/core.hpp>

#include "acquisition/core/frame.h"

namespace todbench {

/// What stages behind the camera made of a frame, on its scale: what an observer judges in place of the counts.
struct JudgedPicture {
  cv::Mat1w counts;
};

/// The frame with what is judged in it as its counts.
[[nodiscard]] Frame as_judged(Frame frame);

}  // namespace todbench
