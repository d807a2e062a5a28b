// SPDX-License-Identifier: GPL-3.0-or-later
// Smear by the time constant of a bolometer that observes a moving target.
#pragma once

#include <complex>
#include <opencv2/core/types.hpp>

#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Returns the transfer function of a bolometer with time constant tau and a target of velocity v: exp(-i x) / (1 - i
/// x) with x = 2 pi (u s_x + w s_y), smear s = v tau, u, w in cycles per pitch. The detector weights the past with
/// exp(-t / tau) / tau. The factor exp(-i x) removes the mean lag, because the target is tracked.
[[nodiscard]] std::complex<double> motion_transfer(double u_per_pitch, double w_per_pitch, cv::Point2d smear_pitch);
/// Returns the distance that the target moves in `seconds`, in pitches of each axis.
[[nodiscard]] cv::Point2d moved_pitch(const SensorSpec& spec, SceneMotion motion, double seconds);
/// Returns the smear v tau in pitches of each axis.
[[nodiscard]] cv::Point2d smear_pitch(const SensorSpec& spec, SceneMotion motion);

}  // namespace todbench
