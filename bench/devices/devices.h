// SPDX-License-Identifier: GPL-3.0-or-later
// Devices that a plan names: cameras, targets and the bench of both.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/camera_registry.h"
#include "bench/devices/experiment_host.h"
#include "bench/plan/loaded_plan.h"
#include "sim_devices/sensor/simulated_camera.h"
#include "tod/measurement/run_controller.h"
#include "tod/presentation/target.h"
#include "tod/presentation/target_wait.h"

namespace todbench {

/// Receives progress messages while a camera is opened, one sentence each.
using SayProgress = std::function<void(std::string_view sentence)>;

/// Returns all back ends of this build: GigE Vision, USB3 Vision, V4L2, recordings, simulated sensors. `stop` aborts a
/// slow opening (`interrupted`); `on_progress` is called about once a second.
[[nodiscard]] CameraRegistry camera_registry(std::stop_token stop = {}, const SayProgress& on_progress = {});

/// Opens a camera as soon as it responds. A camera may be off, or be controlled by a killed program until its heartbeat
/// times out. Errors: those of CameraRegistry::open(); the function waits only after `not_found`. `stop` ends the wait
/// with `interrupted`.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_when_there(const std::string& id,
                                                                   const CameraPatience& patience, std::stop_token stop,
                                                                   const SayProgress& on_progress = {});

/// Library that controls GigE Vision and USB3 Vision cameras.
struct CameraLibrary {
  std::string version;              ///< version at run time, "Aravis 0.8.26"
  std::vector<std::string> faults;  ///< known faults of this version, one sentence each
};
/// Returns the library; empty if this build has none.
[[nodiscard]] std::optional<CameraLibrary> camera_library();

/// Camera and target of a bench, and the host that controls the measurement.
struct OpenedBench {
  std::unique_ptr<FrameSource> camera;
  std::unique_ptr<Target> target;
  bool simulated = false;                 ///< the camera is a sensor model and provides the clock
  std::chrono::milliseconds patience{0};  ///< time to wait for a lost camera; 0 in a replay
  std::unique_ptr<RunController> host = std::make_unique<UnattendedHost>();  ///< may use `camera`
  std::vector<std::string> warnings{};  ///< settings whose read-back differs, one sentence each
};

/// Opens the devices of the plan and writes its settings into the camera. Errors: `not_found`, `invalid_input` (the
/// target cannot work with this camera, or a setting is refused), `calibration` (a setting that scales counts has
/// a wrong value on read-back), `interrupted`. `host` controls the measurement; `on_wait` is called while the target
/// settles.
[[nodiscard]] Result<OpenedBench> open_bench(const LoadedPlan& loaded, std::stop_token stop,
                                             const ExperimentHost& host = {}, const SayProgress& on_progress = {},
                                             const OnTargetWait& on_wait = {});

/// Opens the target of the plan without its camera. Not for a target of kind 'scene', because this target belongs to
/// its camera. Errors: those of the instruments and of the display; `interrupted`.
[[nodiscard]] Result<std::unique_ptr<Target>> open_target(const LoadedPlan& loaded, std::stop_token stop,
                                                          const AskOperator& ask_operator = {},
                                                          const OnTargetWait& on_wait = {});

/// Creates a simulated sensor in front of a scene. `shown_delta_t_k`: set contrast -> contrast shown. A twin can thus
/// show the contrasts that a camera observed. Contrasts without an entry are shown as set. `source`: options of
/// simulated_source().
[[nodiscard]] OpenedBench simulated_bench(std::shared_ptr<const SensorModel> model,
                                          const std::vector<TargetPlate>& plates, double distance_m,
                                          std::map<double, double> shown_delta_t_k, SceneMotion motion = {},
                                          const SimulatedSourceOptions& source = {});

}  // namespace todbench
