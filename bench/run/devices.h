// From the words of a plan to opened devices.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <stop_token>

#include "acquisition/core/camera_registry.h"
#include "bench/plan/plan.h"
#include "bench/run/reconnecting_source.h"
#include "sim_devices/sensor/simulated_camera.h"
#include "tod/measurement/frame_taker.h"
#include "tod/measurement/measurement.h"
#include "tod/presentation/operator_request.h"
#include "tod/presentation/target.h"

namespace todbench {

/// Every back end of this build: GigE Vision, USB3 Vision, V4L2, recordings, simulated sensors.
[[nodiscard]] CameraRegistry camera_registry();

/// How a camera that was lost comes back. Empty functions: it does not.
struct CameraReturn {
  std::chrono::milliseconds patience{0};  ///< how long it is waited for; 0 in a replay
  /// See ReconnectingSource::recover().
  std::function<Result<void>(std::stop_token stop)> recover{};
  /// The plate was found where it was, and the run goes on.
  std::function<void()> confirm{};
};

/// A camera and what changes the target before it.
struct OpenedBench {
  std::unique_ptr<FrameSource> camera;
  std::unique_ptr<Target> target;
  CameraReturn camera_return{};                         ///< its functions use `camera`
  bool simulated = false;                               ///< the camera is a sensor model, its clock that of the model
  std::function<std::int64_t()> now_ns = monotonic_ns;  ///< the clock of the camera's host times
  FramesMeanwhile frames_while_presenting = FramesMeanwhile::leave;
  /// See MeasurementListener::asked_while_presenting.
  std::function<std::int64_t(std::int64_t calls)> remember_calls{};
  /// Told whether the run rests before a presentation, says whether it does: a recording remembers, a replay repeats.
  std::function<bool(bool rests)> remember_rest{};
};

/// Opens what the plan names and writes its settings into the camera. Errors: `not_found`, `invalid_input` (a target
/// that cannot work with this camera, a setting that is refused), `interrupted`.
/// `ask_operator` answers for a target of kind prompt; none: the terminal.
[[nodiscard]] Result<OpenedBench> open_bench(const Plan& plan, const std::vector<TargetPlate>& plates,
                                             std::stop_token stop, const AskOperator& ask_operator = {});

/// Makes the camera of a bench one that is opened again by `reopen` when it was lost.
void let_camera_come_back(OpenedBench& bench, ReopenCamera reopen, ReconnectionOptions options);

/// A simulated sensor behind a scene. `shown_delta_t_k`: set-point -> contrast really shown, so that a twin shows what
/// a camera saw; set-points that are not in it are shown as they are.
[[nodiscard]] OpenedBench simulated_bench(std::shared_ptr<const SensorModel> model,
                                          const std::vector<TargetPlate>& plates, double distance_m,
                                          std::map<double, double> shown_delta_t_k, SceneMotion motion = {});

}  // namespace todbench
