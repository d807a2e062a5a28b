// SPDX-License-Identifier: GPL-3.0-or-later
// Smear by the time constant of a bolometer that observes a moving target.
#pragma once

#include <complex>
#include <opencv2/core/types.hpp>

#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Returns the transfer function of a bolometer with time constant tau and a target of velocity v; smear s = v tau in
/// pitches. The detector weights the past with exp(-t / tau) / tau, so the tail lies behind the target: 1 / (1 - 2 pi i
/// f.s). The factor exp(-2 pi i f.s) removes the mean lag, because the target is tracked.
[[nodiscard]] std::complex<double> motion_transfer(double u_per_pitch, double w_per_pitch, cv::Point2d smear_pitch);
/// Returns the distance that the target moves in `seconds`, in pitches of each axis.
[[nodiscard]] cv::Point2d moved_pitch(const SensorSpec& spec, SceneMotion motion, double seconds);
/// Returns the smear v tau in pitches of each axis.
[[nodiscard]] cv::Point2d smear_pitch(const SensorSpec& spec, SceneMotion motion);

}  // namespace todbench
