// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/trial_plate.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace todbench {
namespace {

constexpr double mark_pitch = 10;       ///< size of the registration marks
constexpr double mark_cell_pitch = 22;  ///< bounding box and margin for blur

}  // namespace

TargetPlate trial_plate(const std::vector<double>& sizes_pitch, double ifov_mrad) {
  TargetPlate plate;
  plate.name = "camera trials";
  const double largest = *std::max_element(sizes_pitch.begin(), sizes_pitch.end());
  // Half a window (1.05 S + 2, rounded up, and the search), half a triangle (0.88 S) and its blur.
  const double cell_mm = (2 * largest + 8) * ifov_mrad;
  const auto rows = (sizes_pitch.size() + 1) / 2;
  const double half_height_mm = 0.5 * static_cast<double>(rows) * cell_mm;
  for (std::size_t t = 0; t < 4 * sizes_pitch.size(); ++t) {
    PlateTriangle triangle;
    triangle.name = std::to_string(t);
    const auto row = t / 8;
    triangle.position_mm = {(static_cast<double>(t % 8) - 3.5) * cell_mm,
                            (static_cast<double>(row) + 0.5) * cell_mm - half_height_mm};
    triangle.size_mm = sizes_pitch[t / 4] * ifov_mrad;
    triangle.apex = static_cast<Apex>((t + t / 4) % 4);
    plate.triangles.push_back(triangle);
  }
  const double mark_mm = mark_cell_pitch * ifov_mrad;
  plate.width_mm = std::max(8 * cell_mm, 2 * mark_mm);
  plate.height_mm = 2 * (half_height_mm + mark_mm);
  for (int m = 0; m < 4; ++m) {
    PlateTriangle mark;
    mark.name = "mark " + std::to_string(m);
    mark.position_mm = {(m % 2 - 0.5) * 0.5 * plate.width_mm, (m < 2 ? -1 : 1) * (half_height_mm + 0.5 * mark_mm)};
    mark.size_mm = mark_pitch * ifov_mrad;
    mark.apex = static_cast<Apex>(m);
    plate.triangles.push_back(mark);
  }
  return plate;
}

SensorSpec cropped_to(SensorSpec sensor, const TargetPlate& plate, int margin_px) {
  const auto pixels = [&](double mm, PitchAxis axis) {
    return static_cast<int>(std::ceil(mm / sensor.ifov_mrad(axis))) + 8 + 2 * margin_px;
  };
  sensor.width = std::max(32, pixels(plate.width_mm, PitchAxis::x));
  sensor.height = std::max(32, pixels(plate.height_mm, PitchAxis::y));
  sensor.distortion_percent = sensor.distortion_r4_percent = 0;  // trials represent the middle of the picture
  return sensor;
}

}  // namespace todbench
