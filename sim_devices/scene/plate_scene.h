// SPDX-License-Identifier: GPL-3.0-or-later
// Plate in front of a simulated camera.
#pragma once

#include <opencv2/core/types.hpp>

#include "sim_devices/scene/scene_motion.h"
#include "tod/plate/target_plate.h"

namespace todbench {

/// Mounted plate at a distance, with its middle near the middle of the picture. Copyable.
struct PlateScene {
  TargetPlate plate;                 ///< as mounted
  double delta_t_k = 0;              ///< temperature of the triangles minus temperature of the surround
  double background_k = 300;         ///< temperature of the surround
  double distance_m = 2;             ///< distance from camera to plate
  cv::Point2d shift_mm{0, 0};        ///< shift of the plate in its own plane
  cv::Point2d centre_px{0.3, -0.2};  ///< middle of the plate at shift 0, from the middle of the picture
  double rotation_deg = 0;           ///< rotation of the plate about the line of sight, clockwise in the picture
  SceneMotion motion{};              ///< motion of the whole plate; a time constant or an exposure smears its picture
};

/// Returns the position in pixels (column, row; pixel centres are integers) of a point on the plate. `sample_mrad`:
/// angle of a pixel along x and y.
[[nodiscard]] cv::Point2d scene_pixel(const PlateScene& scene, cv::Point2d plate_mm, cv::Point2d sample_mrad,
                                      cv::Size sensor);
/// Returns the position for square pixels.
[[nodiscard]] cv::Point2d scene_pixel(const PlateScene& scene, cv::Point2d plate_mm, double ifov_mrad, cv::Size sensor);

/// Returns whether two scenes differ only in temperatures and names.
[[nodiscard]] bool same_geometry(const PlateScene& a, const PlateScene& b);

}  // namespace todbench
