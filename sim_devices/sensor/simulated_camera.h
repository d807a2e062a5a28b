// The sensor model as a camera of the bench, and the scene before it as a target. They share the scene; nothing else
// connects them.
#pragma once

#include <memory>
#include <mutex>

#include "acquisition/core/frame_source.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/presentation/target.h"

namespace todbench {

/// What is in front of a simulated or emulated camera now. Thread-safe.
class SceneHolder {
 public:
  explicit SceneHolder(PlateScene scene);
  [[nodiscard]] std::shared_ptr<const PlateScene> scene() const;
  void set(PlateScene scene);

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const PlateScene> scene_;
};

/// Exposes as fast as it is asked: frame k is expose(scene at that moment, k). `serial` distinguishes twins.
[[nodiscard]] std::unique_ptr<FrameSource> simulated_source(std::shared_ptr<const SensorModel> model,
                                                            std::shared_ptr<const SceneHolder> scene,
                                                            std::string serial);

/// Puts states into the scene at once. Plates in identity mounting.
[[nodiscard]] std::unique_ptr<Target> scene_target(std::shared_ptr<SceneHolder> scene, std::vector<TargetPlate> plates);

}  // namespace todbench
