// From the words of a plan to opened devices.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <stop_token>
#include <string_view>

#include "acquisition/core/camera_registry.h"
#include "bench/plan/loaded_plan.h"
#include "bench/run/experiment_host.h"
#include "sim_devices/sensor/simulated_camera.h"
#include "tod/measurement/measurement_host.h"
#include "tod/presentation/target.h"
#include "tod/presentation/target_wait.h"

namespace todbench {

/// What goes on while a camera is opened, in a sentence.
using SayProgress = std::function<void(std::string_view sentence)>;

/// Every back end of this build: GigE Vision, USB3 Vision, V4L2, recordings, simulated sensors. `stop` ends the opening
/// of a camera that takes its time (`interrupted`), `on_progress` tells of it about once a second.
[[nodiscard]] CameraRegistry camera_registry(std::stop_token stop = {}, const SayProgress& on_progress = {});

/// A camera, what changes the target before it, and who commands a measurement with them.
struct OpenedBench {
  std::unique_ptr<FrameSource> camera;
  std::unique_ptr<Target> target;
  bool simulated = false;                 ///< the camera is a sensor model, its clock that of the model
  std::chrono::milliseconds patience{0};  ///< how long a camera that was lost is waited for; 0 in a replay
  std::unique_ptr<MeasurementHost> host = std::make_unique<UnattendedHost>();  ///< may use `camera`
};

/// Opens what the plan names and writes its settings into the camera. Errors: `not_found`, `invalid_input` (a target
/// that cannot work with this camera, a setting that is refused), `interrupted`.
/// `host` commands what is measured with it; `on_wait` is told while the target takes its time.
[[nodiscard]] Result<OpenedBench> open_bench(const LoadedPlan& loaded, std::stop_token stop,
                                             const ExperimentHost& host = {}, const SayProgress& on_progress = {},
                                             const OnTargetWait& on_wait = {});

/// A simulated sensor behind a scene. `shown_delta_t_k`: set-point -> contrast really shown, so that a twin shows what
/// a camera saw; set-points that are not in it are shown as they are. `source`: of simulated_source().
[[nodiscard]] OpenedBench simulated_bench(std::shared_ptr<const SensorModel> model,
                                          const std::vector<TargetPlate>& plates, double distance_m,
                                          std::map<double, double> shown_delta_t_k, SceneMotion motion = {},
                                          const SimulatedSourceOptions& source = {});

}  // namespace todbench
