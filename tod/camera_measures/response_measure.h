// Response time of a camera from steps of the target's contrast, which it looks at all the while.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <stop_token>
#include <string>

#include "tod/measurement/frame_taker.h"
#include "tod/measurement/measurement_host.h"
#include "tod/measures/step_response.h"
#include "tod/presentation/target.h"

namespace todbench {

struct ResponseOptions {
  std::string plate;                   ///< that steps, in identity mounting
  double delta_t_k = 10;               ///< between which and 0 it steps
  int steps = 16;                      ///< to and fro in turn
  int frames = 24;                     ///< after the target has said that it is there
  int contrast_frames = 16;            ///< that show where the picture changes
  std::optional<double> settling_s{};  ///< of the target's step; nothing: it has to step at once
};

struct ResponseMeasure {
  double delta_t_k = 0;   ///< of a step
  double frame_s = 0;     ///< by the camera's clock
  double settling_s = 0;  ///< of the target, as it is stated; 0: at once
  int dropped = 0;        ///< steps with a correction of the camera in them
  int bright_pixels = 0;  ///< whose mean the signal is, less that of pixels that do not change
  StepResponse response;
};

/// Shows the plate at the contrast and at 0, so that the pixels that change are known; then steps between them, with
/// frames before, during and after each. Errors: `invalid_input` (a target whose settling nobody states), `calibration`
/// (nothing changes in the picture, and those of step_response()), and those of target and camera.
[[nodiscard]] Result<ResponseMeasure> measure_response(FrameTaker& taker, Target& target, MeasurementHost& host,
                                                       const cv::Rect& field, const ResponseOptions& options,
                                                       double frame_rate_hz, const std::stop_token& stop);

}  // namespace todbench
