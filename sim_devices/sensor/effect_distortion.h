// A lens that shows places nearer to or farther from the middle of the picture than a plane projection does.
#pragma once

#include <opencv2/core/types.hpp>

#include "hvs/shape/polygon.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

[[nodiscard]] bool distorts(const SensorSpec& spec);

/// Where a place is seen: q = c + (p - c) (1 + k1 r^2 / R^2 + k2 r^4 / R^4), r = |p - c|, c the middle of the picture
/// and R half its diagonal (Brown 1966). Beyond 1.2 R the radius goes on straight. In samples of a picture of `size`;
/// without distortion the place bit for bit.
[[nodiscard]] cv::Point2d as_lens_shows(cv::Point2d place, const SensorSpec& spec, cv::Size size);

/// The outline that the lens shows of a polygon, whose sides it bends: so many places of each side that straight pieces
/// between them lie within 0.002 samples of the curve.
[[nodiscard]] Polygon as_lens_shows(const Polygon& outline, const SensorSpec& spec, cv::Size size);

}  // namespace todbench
