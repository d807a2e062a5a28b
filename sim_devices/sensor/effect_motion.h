// The memory of a bolometer before a moving target.
#pragma once

#include <complex>
#include <opencv2/core/types.hpp>

#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// A bolometer with time constant tau under a target of velocity v, smear s = v tau in pitches: the detector
/// remembers exp(-t / tau) / tau of what it saw, so the tail is behind the target: 1 / (1 - 2 pi i f.s), times
/// exp(-2 pi i f.s), which takes the mean lag out: the target is tracked.
[[nodiscard]] std::complex<double> motion_transfer(double u_per_pitch, double w_per_pitch, cv::Point2d smear_pitch);
/// v tau in pitches.
[[nodiscard]] cv::Point2d smear_pitch(const SensorSpec& spec, SceneMotion motion);

}  // namespace todbench
