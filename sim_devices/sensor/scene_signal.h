// A scene of the field before a camera: where it is in the picture, and what the samples see of it.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "acquisition/core/result.h"
#include "sim_devices/scene/field_scene.h"
#include "sim_devices/sensor/scene_image.h"

namespace todbench {

struct SceneView {
  double range_m = 100;
  double rotation_deg = 0;         ///< about the line of sight, clockwise in the picture
  cv::Point2d centre_pitch{0, 0};  ///< where the scene's origin is, from the middle of the picture
};

/// Metres of the scene to samples of the camera; sample (i, j) is centred at (i, j).
[[nodiscard]] std::vector<StepEdge> edges_in_samples(const FieldScene& scene, const RadianceScale& scale,
                                                     const SensorSpec& spec, const SceneView& view, cv::Size size);

/// What the samples see of the scene without air, noise and display, in equivalent kelvin above the background. `size`:
/// in samples. `invalid_input` in one sentence: a range that is not positive, a scene smaller than a detector pitch, a
/// picture whose elements are larger than a quarter of one or that is to be turned.
[[nodiscard]] Result<cv::Mat1d> scene_signal_k(const SceneImager& imager, const SensorSpec& spec,
                                               const FieldScene& scene, const RadianceScale& scale,
                                               const SceneView& view, cv::Size size);

}  // namespace todbench
