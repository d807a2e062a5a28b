// SPDX-License-Identifier: GPL-3.0-or-later
// Readout in time: rows of detectors sample one after the other, or in two fields, while the target moves.
#pragma once

#include <opencv2/core.hpp>

#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Returns the distance that the target moves from the time of one row to the time of the next row, in pitches of each
/// axis. The middle row samples at the time of the picture.
[[nodiscard]] cv::Point2d readout_slope(const SensorSpec& spec, SceneMotion motion);

/// Returns the position of a point in a picture with sequential readout. `place`: position of the point if all rows
/// sample together with `middle_row`. `slope`: readout_slope(). The change is a shear along the rows and a stretch
/// across them. The unit is pitches or samples. If the slope is 0, the position is returned bit for bit.
[[nodiscard]] cv::Point2d as_read_out(cv::Point2d place, cv::Point2d slope, double middle_row);

/// Returns the distance that the target moves between the two fields of an interlaced frame, in pitches. The even rows
/// of detectors are the first field. 0 if the frame is progressive or the target does not move.
[[nodiscard]] cv::Point2d way_between_fields(const SensorSpec& spec, SceneMotion motion);

/// Copies the odd rows of detectors of `later` into `picture`. Row 0 of the samples belongs to an even row.
void take_odd_rows(cv::Mat& picture, const cv::Mat& later, int samples_per_pitch);

/// Draws an interlaced picture. The even rows show the scene half of the delay before the time of the picture. The odd
/// rows show the scene half of the delay after this time. `draw` receives a displacement of the target, in pitches, and
/// returns the picture of all rows at one time. If `between_fields` is 0, `draw` is called once.
template <typename Draw>
[[nodiscard]] auto in_fields(cv::Point2d between_fields, int samples_per_pitch, Draw draw) {
  if (between_fields == cv::Point2d(0, 0)) return draw(cv::Point2d(0, 0));
  auto picture = draw(-0.5 * between_fields);
  take_odd_rows(picture, draw(0.5 * between_fields), samples_per_pitch);
  return picture;
}

}  // namespace todbench
