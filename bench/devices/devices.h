// SPDX-License-Identifier: GPL-3.0-or-later
// Opens the devices that a plan names.
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

/// All back ends of this build: GigE Vision, USB3 Vision, V4L2, recordings, simulated sensors. `stop` aborts a slow
/// opening (`interrupted`); `on_progress` is called about once a second.
[[nodiscard]] CameraRegistry camera_registry(std::stop_token stop = {}, const SayProgress& on_progress = {});

/// Opens a camera as soon as it answers: it may be off, or belong to a killed program until the time of its heartbeat
/// is over. Errors: those of CameraRegistry::open(); only `not_found` is waited for. `stop` ends the wait with
/// `interrupted`.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_when_there(const std::string& id,
                                                                   const CameraPatience& patience, std::stop_token stop,
                                                                   const SayProgress& on_progress = {});

/// The library behind GigE Vision and USB3 Vision cameras.
struct CameraLibrary {
  std::string version;              ///< "Aravis 0.8.26", the one that runs
  std::vector<std::string> faults;  ///< known faults of this version, one sentence each
};
/// Empty: this build has none.
[[nodiscard]] std::optional<CameraLibrary> camera_library();

/// A camera, the target in front of it, and the host that controls a measurement with them.
struct OpenedBench {
  std::unique_ptr<FrameSource> camera;
  std::unique_ptr<Target> target;
  bool simulated = false;                 ///< the camera is a sensor model and provides the clock
  std::chrono::milliseconds patience{0};  ///< time to wait for a lost camera; 0 in a replay
  std::unique_ptr<RunController> host = std::make_unique<UnattendedHost>();  ///< may use `camera`
  std::vector<std::string> warnings{};  ///< settings that read back otherwise, one sentence each
};

/// Opens the devices of the plan and writes its settings into the camera. Errors: `not_found`, `invalid_input` (the
/// target cannot work with this camera, or a setting is refused), `calibration` (a setting that scales counts reads
/// back otherwise), `interrupted`. `host` controls the measurement; `on_wait` is called while the target
/// settles.
[[nodiscard]] Result<OpenedBench> open_bench(const LoadedPlan& loaded, std::stop_token stop,
                                             const ExperimentHost& host = {}, const SayProgress& on_progress = {},
                                             const OnTargetWait& on_wait = {});

/// Opens the target of the plan without its camera. Not for a target of kind 'scene', which belongs to its camera.
/// Errors: those of the instruments and of the display; `interrupted`.
[[nodiscard]] Result<std::unique_ptr<Target>> open_target(const LoadedPlan& loaded, std::stop_token stop,
                                                          const AskOperator& ask_operator = {},
                                                          const OnTargetWait& on_wait = {});

/// Creates a simulated sensor in front of a scene. `shown_delta_t_k`: set contrast -> contrast shown, so that a twin
/// shows the contrasts that a camera observed; others are shown as set. `source`: options of simulated_source().
[[nodiscard]] OpenedBench simulated_bench(std::shared_ptr<const SensorModel> model,
                                          const std::vector<TargetPlate>& plates, double distance_m,
                                          std::map<double, double> shown_delta_t_k, SceneMotion motion = {},
                                          const SimulatedSourceOptions& source = {});

}  // namespace todbench
