// SPDX-License-Identifier: GPL-3.0-or-later
// Response time of a camera from steps of the target's contrast while it records.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <stop_token>
#include <string>

#include "tod/measurement/frame_taker.h"
#include "tod/measurement/run_controller.h"
#include "tod/measures/step_response.h"
#include "tod/presentation/target.h"

namespace todbench {

/// Signal whose steps are followed.
enum class StepSignal {
  contrast,  ///< of the pixels that change with the target against those that do not: response of the detector
  surround,  ///< level round the target, which follows its contrast only if the camera controls its gain
};

/// Options of measure_response().
struct ResponseOptions {
  std::string plate;                   ///< plate of the steps, in identity mounting
  double delta_t_k = 10;               ///< the contrast steps between 0 and this
  int steps = 16;                      ///< up and down in turn
  int frames = 24;                     ///< recorded after the target has reported the end of a step
  int contrast_frames = 16;            ///< averaged to find the pixels that change
  std::optional<double> settling_s{};  ///< of the target's step; empty: the target must step at once
  StepSignal signal = StepSignal::contrast;
};

/// Result of measure_response().
struct ResponseMeasure {
  double delta_t_k = 0;   ///< of a step
  double frame_s = 0;     ///< by the camera's clock
  double settling_s = 0;  ///< stated settling of the target; 0: at once
  int dropped = 0;        ///< steps that contain a correction of the camera
  int bright_pixels = 0;  ///< the signal is their mean minus that of pixels that do not change
  double change = 0;      ///< of the signal by a step, in the unit of the picture
  StepResponse response;
};

/// Shows the plate at the contrast and at 0 to find the pixels of the signal, then steps between them, with frames
/// before, during and after each step. Errors: `invalid_input` (settling of the target not stated), `calibration`
/// (the signal does not change, and those of step_response()), and those of target and camera.
[[nodiscard]] Result<ResponseMeasure> measure_response(FrameTaker& taker, Target& target, RunController& host,
                                                       const cv::Rect& field, const ResponseOptions& options,
                                                       double frame_rate_hz, const std::stop_token& stop);

}  // namespace todbench
