// SPDX-License-Identifier: GPL-3.0-or-later
// Displayed picture of a target in a window of samples, without noise.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "hvs/shape/painted_shapes.h"
#include "sim_devices/sensor/scene_image.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Renderer of the displayed picture of a target for one camera. Immutable, thread-safe.
class SeenWindow {
 public:
  /// Precondition: `spec` is as_planned(). `imager` must outlive the object.
  SeenWindow(const SensorSpec& spec, const SceneImager& imager);
  /// Returns the picture of edges in samples round their origin, which lies `offset` samples from the middle of the
  /// window. Steps are multiplied by `factor`. The image dance is that of presentation `number`.
  [[nodiscard]] cv::Mat1f picture(const std::vector<StepEdge>& edges, int window_samples, cv::Point2d offset,
                                  double factor, std::uint64_t number) const;

 private:
  SensorSpec spec_;
  const SceneImager* imager_;
  std::vector<double> taps_;  ///< taps of the display
};

}  // namespace todbench
