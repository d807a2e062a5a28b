// What a camera behind its display shows of a target in a window of samples, without noise.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "hvs/shape/painted_shapes.h"
#include "sim_devices/sensor/scene_image.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// One of all that a camera shows. Immutable, thread-safe.
class SeenWindow {
 public:
  /// `spec` as planned; `imager` outlives the object.
  SeenWindow(const SensorSpec& spec, const SceneImager& imager);
  /// Edges in samples round the origin, which lies `offset` from the middle of the window; their steps times `factor`.
  /// Where the air lets pictures dance, it is displaced from there as in presentation `number` of many.
  [[nodiscard]] cv::Mat1f picture(const std::vector<StepEdge>& edges, int window_samples, cv::Point2d offset,
                                  double factor, std::uint64_t number) const;

 private:
  SensorSpec spec_;
  const SceneImager* imager_;
  std::vector<double> taps_;  ///< of the display
};

}  // namespace todbench
