// SPDX-License-Identifier: GPL-3.0-or-later
// Radial distortion of the lens: points are displaced towards the middle of the picture or away from it.
#pragma once

#include <opencv2/core/types.hpp>

#include "hvs/shape/polygon.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Returns whether the lens of this sensor distorts.
[[nodiscard]] bool distorts(const SensorSpec& spec);

/// Returns the distorted position q = c + (p - c) (1 + k1 r^2 / R^2 + k2 r^4 / R^4), r = |p - c| (Brown 1966). c is the
/// middle of the picture and R half its diagonal, both in samples of the distorted picture of `size`. Beyond 1.2 R the
/// radius continues linearly. Without distortion the position is returned bit for bit.
[[nodiscard]] cv::Point2d as_lens_shows(cv::Point2d place, const SensorSpec& spec, cv::Size size);

/// Returns the distorted outline of a polygon. Each side is divided so that straight pieces lie within 0.002 samples of
/// the curve.
[[nodiscard]] Polygon as_lens_shows(const Polygon& outline, const SensorSpec& spec, cv::Size size);

}  // namespace todbench
