// Time constant of a camera from steps of what it looks at.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

/// Frames before, during and after one step of the target.
struct StepSeries {
  bool rising = true;
  std::size_t before = 0;      ///< so many of the first samples were taken before the step was asked for, two or more
  std::vector<double> time_s;  ///< of each frame by the camera's clock, rising
  std::vector<double> signal;  ///< in any linear unit
};

struct StepResponseOptions {
  double frame_s = 0;     ///< from frame to frame, > 0; exposure and readout of a frame are over within it
  double settling_s = 0;  ///< within which the target does its step but for `settling_left` of it
};
/// Part of a step that a target may have left after its settling time.
inline constexpr double settling_left = 0.001;

/// With its 95 % interval.
struct StepTimeConstant {
  double value_s = 0, low_s = 0, high_s = 0;
  int steps = 0;
};

/// A sample that was fitted, as the part of the step that is left `time_s` after the step, by the fit.
struct StepPoint {
  double time_s = 0, left = 0;
  bool rising = true;
  bool operator==(const StepPoint&) const = default;
};

struct StepResponse {
  StepTimeConstant both;
  std::optional<StepTimeConstant> rise{}, fall{};  ///< nothing: cannot be told by themselves
  double p_first_order = 1;                        ///< of what the fit leaves, against a second-order term (F test)
  double largest_left = 0;                         ///< of the step, in the first fitted sample of a step: median
  int samples = 0;                                 ///< that were fitted
  std::vector<StepPoint> points;
};

inline constexpr std::size_t least_steps = 4;

/// y = a + g exp(-t / T) with one T for all steps, by least squares. The frame clock does not know when the step
/// comes, so amplitudes are free, and a step is fitted from the first frame on whose exposure began when it was over: a
/// frame and the settling time after the first that shows it. From there on successive differences fall by exp(-frame /
/// T) whatever the exposure is. The interval is the wider one of where the sum of squares stays below what chance
/// explains (F, 95 %) and of a jackknife over the steps (Student's t); with a settling time it is joined with what is
/// left of the target's own step. Errors: `invalid_input` (fewer than four steps, or samples that cannot be
/// fitted), `calibration` where there is no time constant to be told: no step stands out of the noise; nothing is left
/// of it after the first frames (the camera is faster than its frames show, or the target's own settling covers it); it
/// goes on for longer than was watched; it is not of first order.
[[nodiscard]] Result<StepResponse> step_response(std::span<const StepSeries> steps, const StepResponseOptions& options);

}  // namespace todbench
