// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/scene/plate_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace todbench {

cv::Point2d scene_pixel(const PlateScene& scene, cv::Point2d plate_mm, double ifov_mrad, cv::Size sensor) {
  return scene_pixel(scene, plate_mm, cv::Point2d(ifov_mrad, ifov_mrad), sensor);
}

cv::Point2d scene_pixel(const PlateScene& scene, cv::Point2d plate_mm, cv::Point2d sample_mrad, cv::Size sensor) {
  // A plane through a lens without distortion: millimetres over metres are milliradians of the tangent.
  const cv::Point2d px = (plate_mm + scene.shift_mm) * (1 / (scene.distance_m * sample_mrad.x));
  const double angle = scene.rotation_deg * std::numbers::pi / 180;
  const cv::Point2d turned(px.x * std::cos(angle) - px.y * std::sin(angle),
                           px.x * std::sin(angle) + px.y * std::cos(angle));
  return cv::Point2d(turned.x, turned.y * (sample_mrad.x / sample_mrad.y)) + scene.centre_px +
         cv::Point2d((sensor.width - 1) / 2.0, (sensor.height - 1) / 2.0);
}

bool same_geometry(const PlateScene& a, const PlateScene& b) {
  const auto same_triangle = [](const PlateTriangle& s, const PlateTriangle& t) {
    return s.position_mm == t.position_mm && s.size_mm == t.size_mm && s.apex == t.apex;
  };
  const auto same_rectangle = [](const PlateRectangle& s, const PlateRectangle& t) {
    return s.position_mm == t.position_mm && s.size_mm == t.size_mm && s.angle_deg == t.angle_deg;
  };
  const auto same_bars = [](const PlateBars& s, const PlateBars& t) {
    return s.position_mm == t.position_mm && s.bar_mm == t.bar_mm && s.length_mm == t.length_mm &&
           s.angle_deg == t.angle_deg;
  };
  return a.distance_m == b.distance_m && a.shift_mm == b.shift_mm && a.centre_px == b.centre_px &&
         a.rotation_deg == b.rotation_deg && a.motion == b.motion &&
         std::equal(a.plate.triangles.begin(), a.plate.triangles.end(), b.plate.triangles.begin(),
                    b.plate.triangles.end(), same_triangle) &&
         std::equal(a.plate.rectangles.begin(), a.plate.rectangles.end(), b.plate.rectangles.begin(),
                    b.plate.rectangles.end(), same_rectangle) &&
         std::equal(a.plate.bars.begin(), a.plate.bars.end(), b.plate.bars.begin(), b.plate.bars.end(), same_bars);
}

}  // namespace todbench
