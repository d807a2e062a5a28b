// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/effect_readout.h"

#include <cmath>

#include "sim_devices/sensor/effect_motion.h"
#include "sim_devices/sensor/effect_row.h"

namespace todbench {
namespace {

constexpr double steepest = 0.1;  // pitches per row; beyond it the bound does not hold

}  // namespace

cv::Point2d readout_slope(const SensorSpec& spec, SceneMotion motion) {
  return moved_pitch(spec, motion, spec.row_time_us * 1e-6);
}

cv::Point2d as_read_out(cv::Point2d place, cv::Point2d slope, double middle_row) {
  // The row y' that samples a place observes it displaced: y' - middle = (y - middle) + slope.y (y' - middle).
  if (slope == cv::Point2d(0, 0)) return place;
  const double row = (place.y - middle_row) / (1 - slope.y);
  return {place.x + slope.x * row, middle_row + row};
}

cv::Point2d way_between_fields(const SensorSpec& spec, SceneMotion motion) {
  return moved_pitch(spec, motion, spec.field_delay_ms * 1e-3);
}

void take_odd_rows(cv::Mat& picture, const cv::Mat& later, int samples_per_pitch) {
  for (int row = 0; row < picture.rows; ++row) {
    if (row / samples_per_pitch % 2 == 1) later.row(row).copyTo(picture.row(row));
  }
}

EffectRow effect_rows::readout() {
  EffectRow row;
  row.title = "Readout of the rows";
  row.keys = {{"row_time_us", &SensorSpec::row_time_us, NumberRange::between(0, 1e4), KeyPresence::optional,
               "time between the sampling of successive rows; 0: all rows at once"},
              {"field_delay_ms", &SensorSpec::field_delay_ms, NumberRange::between(0, 1e3), KeyPresence::optional,
               "time from the even to the odd rows of an interlaced frame; 0: progressive"}};
  row.impossible = [](const SensorSpec& spec) -> std::string {
    const double whole_us = spec.row_time_us * spec.height + 1e3 * spec.field_delay_ms;
    if (whole_us * spec.frame_rate_hz <= 1e6 * (1 + 1e-9)) return "";
    if (spec.field_delay_ms == 0) return "row_time_us times height must not be longer than the frame period";
    return "field_delay_ms and row_time_us times height together must not be longer than the frame period";
  };
  row.is_neutral = [](const SensorSpec& spec, SceneMotion motion) {
    return (spec.row_time_us == 0 && spec.field_delay_ms == 0) || !motion.moving();
  };
  row.neutralise = [](SensorSpec& spec) { spec.row_time_us = 0, spec.field_delay_ms = 0; };
  row.neutral = "row_time_us and field_delay_ms are 0, or the target does not move";
  row.directions = AxisDirections::different;
  row.stage = stage::Readout{[](const SensorSpec& spec, SceneMotion motion) { return readout_slope(spec, motion); }};
  // A shear by a turns edges by at most a, and a stretch by a changes the size by a: the change is below a. Fields tear
  // an edge, for which there is no bound.
  row.bound = [](const ExpectedScene& scene) -> std::optional<double> {
    const cv::Point2d slope = readout_slope(scene.spec, scene.motion);
    const double length = std::hypot(slope.x / scene.spec.pitch_aspect(), slope.y);
    if (length >= steepest || way_between_fields(scene.spec, scene.motion) != cv::Point2d(0, 0)) return std::nullopt;
    return length;
  };
  row.always =
      "always simulated: fields of a moving target, and motion of at least a tenth of a pitch from row to row, are "
      "outside the range of the criterion";
  return row;
}

}  // namespace todbench
