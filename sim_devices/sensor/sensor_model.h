// The simulated sensor: a pure function from scene and index to a frame.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>

#include "acquisition/core/accuracy.h"
#include "acquisition/core/rng.h"
#include "hvs/polygon_image.h"
#include "sim_devices/scene/plate_scene.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Immutable but for internal caches; thread-safe. The same (scene, index) gives the same frame on every machine and
/// thread.
class SensorModel {
 public:
  /// Precondition: validate(spec) succeeds.
  SensorModel(SensorSpec spec, SensorPlan plan, Accuracy accuracy, std::uint64_t seed);
  ~SensorModel();
  SensorModel(const SensorModel&) = delete;
  SensorModel& operator=(const SensorModel&) = delete;

  [[nodiscard]] const SensorSpec& spec() const;
  [[nodiscard]] const SensorPlan& plan() const;

  /// The picture before noise, in kelvin. The last few scenes are cached.
  [[nodiscard]] std::shared_ptr<const cv::Mat1f> irradiance(const PlateScene& scene) const;
  /// Frame `index`: irradiance, temporal noise, fixed pattern, quantisation to counts, clipped to the significant bits.
  [[nodiscard]] cv::Mat1w expose(const PlateScene& scene, std::uint64_t index) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace todbench
