// SPDX-License-Identifier: GPL-3.0-or-later
// Radial distortion of the lens: points are displaced towards the middle of the picture or away from it.
#pragma once

#include <opencv2/core/types.hpp>

#include "hvs/shape/polygon.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Returns whether the lens of this sensor distorts.
[[nodiscard]] bool distorts(const SensorSpec& spec);

/// Returns the distorted position q = c + (p - c) (1 + k1 s^2 + k2 s^4) of p = `place`, s = |p - c| / R (Brown 1966).
/// c: middle of the picture of `size` samples; R: half its diagonal; k1, k2: distortion_percent and
/// distortion_r4_percent over 100. Linear beyond s = 1.2. Without distortion the position is returned bit for bit.
[[nodiscard]] cv::Point2d as_lens_shows(cv::Point2d place, const SensorSpec& spec, cv::Size size);

/// Returns the distorted outline of a polygon. Each side is divided so that straight pieces lie within 0.002 samples of
/// the curve.
[[nodiscard]] Polygon as_lens_shows(const Polygon& outline, const SensorSpec& spec, cv::Size size);

}  // namespace todbench
