// SPDX-License-Identifier: GPL-3.0-or-later
// Time constant of a camera from steps of the observed scene.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// Frames before, during and after one step of the target.
struct StepSeries {
  bool rising = true;
  std::size_t before = 0;      ///< number of samples taken before the step was requested, at least two
  std::vector<double> time_s;  ///< time of each frame by the camera's clock, increasing
  std::vector<double> signal;  ///< in any linear unit
};

/// Properties of camera and target.
struct StepResponseOptions {
  double frame_s = 0;     ///< frame interval, > 0; exposure and readout of a frame end within it
  double settling_s = 0;  ///< time after which at most `settling_left` of the target's step remains
};
/// Part of a step that may remain after the target's settling time.
inline constexpr double settling_left = 0.001;

/// A time constant with its 95 % interval.
struct StepTimeConstant {
  double value_s = 0, low_s = 0, high_s = 0;
  int steps = 0;
};

/// A fitted sample: the part of the step that remains at `time_s` after the step, according to the fit.
struct StepPoint {
  double time_s = 0, left = 0;
  bool rising = true;
  bool operator==(const StepPoint&) const = default;
};

/// Result of step_response().
struct StepResponse {
  StepTimeConstant both;
  std::optional<StepTimeConstant> rise{}, fall{};  ///< empty: cannot be determined separately
  double p_first_order = 1;  ///< p value of the first-order fit against a second-order term (F test)
  double largest_left = 0;   ///< part of the step that remains in its first fitted sample: median
  int samples = 0;           ///< fitted samples
  std::vector<StepPoint> points;
};

/// Minimum number of steps of step_response().
inline constexpr std::size_t least_steps = 4;

/// Fits y = a + g exp(-t / T) with one T for all steps, by least squares. The time of the step is not known on the
/// frame clock, so amplitudes are free parameters. A step is fitted from the first frame whose exposure began after the
/// step: one frame and the settling time after the first frame that shows the step. From there on, successive
/// differences decrease by exp(-frame / T) for any exposure. The interval is the wider one of two: the range in which
/// the sum of squares is compatible with chance (F, 95 %), and a jackknife over the steps (Student's t). With a
/// settling time it includes the remainder of the target's own step.
///
/// Errors: `invalid_input` (fewer than four steps, or samples that cannot be fitted), `calibration` if no time constant
/// can be determined. In that case no step exceeds the noise; or no signal remains after the first frames (the camera
/// is faster than its frames show, or the target's settling covers it); or the response is longer than the recording,
/// or not of first order.
[[nodiscard]] Result<StepResponse> step_response(std::span<const StepSeries> steps, const StepResponseOptions& options);

}  // namespace todbench
