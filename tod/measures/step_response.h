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
  std::vector<double> signal;  ///< signal of each frame in any linear unit
};

/// Properties of camera and target.
struct StepResponseOptions {
  double frame_s = 0;     ///< frame interval, > 0; exposure and readout of a frame are shorter than this interval
  double settling_s = 0;  ///< time after which at most the share `settling_left` of the target's step remains
};
/// Share of a step that may remain after the settling time of the target.
inline constexpr double settling_left = 0.001;

/// A time constant with its 95 % interval.
struct StepTimeConstant {
  double value_s = 0, low_s = 0, high_s = 0;
  int steps = 0;
};

/// A fitted sample.
struct StepPoint {
  /// Time after the step, and share of the step that remains at this time.
  double time_s = 0, left = 0;
  bool rising = true;
  bool operator==(const StepPoint&) const = default;
};

/// Result of step_response().
struct StepResponse {
  StepTimeConstant both;
  /// Time constants of rising and of falling steps; empty: they cannot be determined separately.
  std::optional<StepTimeConstant> rise{}, fall{};
  double p_first_order = 1;  ///< p value of the F test for a second-order term
  double largest_left = 0;   ///< share of the step that remains in the first fitted sample, median over the steps
  int samples = 0;           ///< fitted samples
  std::vector<StepPoint> points;
};

/// Minimum number of steps of step_response().
inline constexpr std::size_t least_steps = 4;

/// Fits the signal y = a + g exp(-t / T) at time t by least squares: one T for all steps, a and g for each step. The
/// time of the step is not known on the clock of the frames, so amplitudes are free parameters. The fit of a step
/// begins one frame interval plus the settling time after the first frame that shows the step. All exposures from then
/// on begin after the step. From this frame on, successive differences decrease by the factor exp(-frame_s / T) for any
/// exposure. There are two estimates of the interval: the range in which the sum of squares is compatible with chance
/// (F test, 95 %), and a jackknife over the steps (Student's t). The wider interval is used. If there is a settling
/// time, the interval includes the remainder of the target's step.
///
/// Errors: `invalid_input` (fewer than four steps, or samples that cannot be fitted); `calibration` if no time constant
/// can be determined. The causes are: no step exceeds the noise; no signal remains after the first frames, because the
/// camera is too fast for its frame rate or the target settles too slowly; the response is longer than the recording;
/// the response is not of first order.
[[nodiscard]] Result<StepResponse> step_response(std::span<const StepSeries> steps, const StepResponseOptions& options);

}  // namespace todbench
