// A detector that integrates and holds, before a moving target.
#pragma once

#include <complex>
#include <opencv2/core/types.hpp>

#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// An exposure of length T under a target of velocity v, way b = v T in pitches: the mean over the way, sin(x) / x with
/// x = pi f.b. It is about the middle of the exposure: the mean lag, b / 2 behind the end of it, is taken out.
[[nodiscard]] double exposure_transfer(double u_per_pitch, double w_per_pitch, cv::Point2d way_pitch);
/// v T in pitches.
[[nodiscard]] cv::Point2d exposure_way_pitch(const SensorSpec& spec, SceneMotion motion);

/// How far the picture of a moving target is behind the target at the instant of the sample, which ends the exposure:
/// v (tau + T / 2), in pitches. The transfers of time constant and exposure have it taken out.
[[nodiscard]] cv::Point2d mean_lag_pitch(const SensorSpec& spec, SceneMotion motion);

}  // namespace todbench
