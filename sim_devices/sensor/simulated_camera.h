// SPDX-License-Identifier: GPL-3.0-or-later
// Sensor model as a camera of the bench, and the scene in front of it as a target. Only the scene connects the two.
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

/// The present scene of a simulated or emulated camera. Thread-safe.
class SceneHolder {
 public:
  explicit SceneHolder(PlateScene scene);
  [[nodiscard]] std::shared_ptr<const PlateScene> scene() const;
  /// Sets the scene. Every detector is then treated as settled to this scene.
  void set(PlateScene scene);
  /// Steps the contrast between the last frame and the next frame. The times of successive steps are spread evenly over
  /// the frame period.
  void step_to(double delta_t_k);
  /// Returns the scene at a time of the camera's clock, and stores this time as the present time. During a run the
  /// plate moves. After a step the scene has the contrast that the detector of `spec` has reached.
  [[nodiscard]] PlateScene scene_at(double time_s, const SensorSpec& spec);
  /// Starts a run along x from the present position of the plate to `to_mm`; the next set() ends the run.
  PlateRun run_along_x(double to_mm, double speed_mm_s);

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const PlateScene> scene_;
  std::optional<PlateRun> run_;
  std::optional<ContrastSteps> steps_;  ///< since the scene was set
  int steps_made_ = 0;
  bool steps_next_ = false;  ///< step to the contrast of the scene, before the next frame
  double time_s_ = 0;
};

/// Options of a simulated camera.
struct SimulatedSourceOptions {
  ModuleSensor::OnLine on_error_line{};  ///< receives error output of the program in place of the sensor
  int dither = 1;                        ///< n positions per axis: frame k shows the scene displaced by dither_px(n, k)
};

/// Returns a camera without delay: frame k is expose(present scene, k) of the model or of the program in place of the
/// sensor. `serial` distinguishes cameras with the same sensor.
[[nodiscard]] std::unique_ptr<FrameSource> simulated_source(std::shared_ptr<const SensorModel> model,
                                                            std::shared_ptr<SceneHolder> scene, std::string serial,
                                                            const SimulatedSourceOptions& options = {});

/// Returns a target that sets each state of the scene without delay. Plates are in identity mounting.
[[nodiscard]] std::unique_ptr<Target> scene_target(std::shared_ptr<SceneHolder> scene, std::vector<TargetPlate> plates);

}  // namespace todbench
