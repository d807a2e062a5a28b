// SPDX-License-Identifier: GPL-3.0-or-later
// A field scene in front of a camera: its position in the picture, and the signal of the samples.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "acquisition/base/result.h"
#include "sim_devices/scene/field_scene.h"
#include "sim_devices/sensor/scene_image.h"

namespace todbench {

/// Position and motion of a scene in the picture.
struct SceneView {
  double range_m = 100;
  double rotation_deg = 0;         ///< about the line of sight, clockwise in the picture
  cv::Point2d centre_pitch{0, 0};  ///< position of the scene's origin, from the middle of the picture
  /// Motion of the scene from one row to the next, in pitches per row (effect_readout.h). The middle row of the picture
  /// samples at the time of the picture. Polygons only.
  cv::Point2d readout_slope{0, 0};
};

/// Returns the edges of a scene, converted from metres in the scene to samples of the camera; sample (i, j) is centred
/// at (i, j). `size`: picture in samples.
[[nodiscard]] std::vector<StepEdge> edges_in_samples(const FieldScene& scene, const RadianceScale& scale,
                                                     const SensorSpec& spec, const SceneView& view, cv::Size size);

/// Returns the signal of the samples without air, noise and display, in equivalent kelvin above the background. `size`
/// in samples. Errors: `invalid_input` (a range that is not positive, a scene smaller than a detector pitch, a picture
/// with elements larger than a quarter of a pitch, or a rotated picture).
[[nodiscard]] Result<cv::Mat1d> scene_signal_k(const SceneImager& imager, const SensorSpec& spec,
                                               const FieldScene& scene, const RadianceScale& scale,
                                               const SceneView& view, cv::Size size);

}  // namespace todbench
