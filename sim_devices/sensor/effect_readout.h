// SPDX-License-Identifier: GPL-3.0-or-later
// Sequential readout: rows of detectors sample one after the other, while the target moves.
#pragma once

#include <opencv2/core/types.hpp>

#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Motion of the target from one row to the next, v t, in pitches. The middle row samples at the time of the picture.
[[nodiscard]] cv::Point2d readout_slope(const SensorSpec& spec, SceneMotion motion);

/// Place with sequential readout of a point that lies at `place` if all rows sample with `middle_row`: a shear along
/// the rows and a stretch across them. In pitches or samples. A slope of 0 returns the place bit for bit.
[[nodiscard]] cv::Point2d as_read_out(cv::Point2d place, cv::Point2d slope, double middle_row);

}  // namespace todbench
