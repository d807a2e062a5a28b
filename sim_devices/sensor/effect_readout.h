// Rows of detectors that are sampled one after the other, before a moving target.
#pragma once

#include <opencv2/core/types.hpp>

#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// v t with t from one row to the next: what the target moves meanwhile, in pitches. The row in the middle of the
/// picture samples when the picture is said to be taken.
[[nodiscard]] cv::Point2d readout_slope(const SensorSpec& spec, SceneMotion motion);

/// Where a place of the picture is that would be at `place` if all rows were sampled with `middle_row`: a shear along
/// the rows, a stretch across. Unit free (pitches or samples); a slope of 0 leaves the place bit for bit.
[[nodiscard]] cv::Point2d as_read_out(cv::Point2d place, cv::Point2d slope, double middle_row);

}  // namespace todbench
