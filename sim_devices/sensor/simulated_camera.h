// The sensor model as a camera of the bench, and the scene before it as a target. They share the scene; nothing else
// connects them.
#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "acquisition/core/frame_source.h"
#include "sim_devices/sensor/contrast_steps.h"
#include "sim_devices/sensor/module_sensor.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/presentation/target.h"

namespace todbench {

/// What is in front of a simulated or emulated camera now. Thread-safe.
class SceneHolder {
 public:
  explicit SceneHolder(PlateScene scene);
  [[nodiscard]] std::shared_ptr<const PlateScene> scene() const;
  /// The scene has been there long enough for any detector.
  void set(PlateScene scene);
  /// The contrast steps at a moment between the last frame and the next: such moments are spread evenly over frames.
  void step_to(double delta_t_k);
  /// The scene in a run, if there is one, at a time of the camera's clock, which is remembered as the time that it is;
  /// after a step with the contrast that the sensor has taken in.
  [[nodiscard]] PlateScene scene_at(double time_s, const SensorSpec& spec);
  /// Runs along x from where the plate is, from now on; the next set() ends it.
  PlateRun run_along_x(double to_mm, double speed_mm_s);

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const PlateScene> scene_;
  std::optional<PlateRun> run_;
  std::optional<ContrastSteps> steps_;  ///< since the scene was set
  int steps_made_ = 0;
  bool steps_next_ = false;  ///< to the contrast of the scene, before the next frame
  double time_s_ = 0;
};

struct SimulatedSourceOptions {
  ModuleSensor::OnLine on_error_line{};  ///< of the program that is the sensor
  int dither = 1;                        ///< n: frame k shows the scene displaced by dither_px(n, k)
};

/// Exposes as fast as it is asked: frame k is expose(scene at that moment, k), of the model or of the program that is
/// the sensor. `serial` distinguishes twins.
[[nodiscard]] std::unique_ptr<FrameSource> simulated_source(std::shared_ptr<const SensorModel> model,
                                                            std::shared_ptr<SceneHolder> scene, std::string serial,
                                                            const SimulatedSourceOptions& options = {});

/// Puts states into the scene at once. Plates in identity mounting.
[[nodiscard]] std::unique_ptr<Target> scene_target(std::shared_ptr<SceneHolder> scene, std::vector<TargetPlate> plates);

}  // namespace todbench
