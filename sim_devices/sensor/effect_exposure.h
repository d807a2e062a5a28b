// SPDX-License-Identifier: GPL-3.0-or-later
// Smear by a detector that integrates during an exposure while the target moves.
#pragma once

#include <complex>
#include <opencv2/core/types.hpp>

#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Returns the transfer function of an exposure T with a target of velocity v, sin(x) / x with x = pi (u b_x + w b_y).
/// u, w: frequencies in cycles per pitch; b = v T: path of the target during the exposure, `way_pitch`. The mean lag of
/// b / 2 is removed: the smear is centred on the middle of the exposure.
[[nodiscard]] double exposure_transfer(double u_per_pitch, double w_per_pitch, cv::Point2d way_pitch);
/// Returns the path v T of the target during the exposure, in pitches of each axis.
[[nodiscard]] cv::Point2d exposure_way_pitch(const SensorSpec& spec, SceneMotion motion);

/// Returns the distance by which the picture of a moving target lags behind the target at the end of the exposure, in
/// pitches: v (tau + T / 2), tau: time constant, T: exposure. The transfer functions do not contain this lag.
[[nodiscard]] cv::Point2d mean_lag_pitch(const SensorSpec& spec, SceneMotion motion);

}  // namespace todbench
