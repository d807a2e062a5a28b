// SPDX-License-Identifier: GPL-3.0-or-later
// Response time of a camera, from frames recorded while the contrast of the target steps.
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

/// Signal whose response to the steps is evaluated.
enum class StepSignal {
  contrast,  ///< mean of the pixels that change with the target minus mean of the other pixels: response of the
             ///< detector
  surround,  ///< level round the target; it changes with the contrast only if the camera has an automatic gain
};

/// Options of measure_response().
struct ResponseOptions {
  std::string plate;         ///< plate shown during the steps, in identity mounting
  double delta_t_k = 10;     ///< the contrast steps between 0 and this value
  int steps = 16;            ///< number of steps, alternately up and down
  int frames = 24;           ///< number of frames recorded after the target has reported the end of a step
  int contrast_frames = 16;  ///< number of frames averaged to find the pixels that change
  /// Settling time of the contrast of the target. Empty: a target that steps instantly is required.
  std::optional<double> settling_s{};
  StepSignal signal = StepSignal::contrast;
};

/// Result of measure_response().
struct ResponseMeasure {
  /// Contrast of a step.
  double delta_t_k = 0;
  double frame_s = 0;     ///< frame interval by the camera's clock
  double settling_s = 0;  ///< stated settling time of the target; 0: instant
  int dropped = 0;        ///< number of steps that are excluded because of a correction of the camera
  /// Number of pixels that change. The signal is the mean of these pixels minus the mean of the pixels that do not
  /// change.
  int bright_pixels = 0;
  double change = 0;  ///< change of the signal in a step, in the unit of the picture
  StepResponse response;
};

/// Shows the plate at the contrast and at a contrast of 0 to find the pixels of the signal. Then steps between these
/// contrasts and takes frames before, during and after each step. Errors: `invalid_input` (settling of the target not
/// stated), `calibration` (the signal does not change, and those of step_response()), and those of target and camera.
[[nodiscard]] Result<ResponseMeasure> measure_response(FrameTaker& taker, Target& target, RunController& host,
                                                       const cv::Rect& field, const ResponseOptions& options,
                                                       double frame_rate_hz, const std::stop_token& stop);

}  // namespace todbench
