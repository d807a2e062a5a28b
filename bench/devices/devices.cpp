// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/devices/devices.h"

#include <algorithm>
#include <condition_variable>
#include <mutex>

#include "acquisition/base/try.h"
#include "acquisition/core/camera_id.h"
#include "acquisition/core/control_text.h"
#include "acquisition/recording/recording_backend.h"
#include "bench/devices/bench_host.h"
#include "bench/devices/camera_settings.h"
#include "bench/devices/display_target.h"
#include "bench/devices/reconnecting_source.h"
#include "bench/devices/terminal_operator.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/plan_options.h"
#include "bench/plan/resources.h"
#include "bench/session/answered_instruments.h"
#include "tod/instruments/prompt_target.h"
#include "tod/instruments/scpi_target.h"
#include "tod/presentation/target_failure.h"
#ifdef TODBENCH_WITH_ARAVIS
#include "acquisition/aravis/aravis_backend.h"
#include "acquisition/aravis/aravis_version.h"
#endif
#ifdef TODBENCH_WITH_USB
#include "acquisition/usb/usb_backend.h"
#endif
#ifdef TODBENCH_WITH_V4L2
#include "acquisition/v4l2/v4l2_backend.h"
#endif

namespace todbench {
namespace {

/// A scene without a plate: the view of a simulated camera without a target.
PlateScene empty_scene(double distance_m) {
  PlateScene scene;
  scene.distance_m = distance_m;
  return scene;
}

/// Simulated sensors by name, "sim:sc2000", with an empty scene.
class SimulatedBackend final : public CameraBackend {
 public:
  [[nodiscard]] std::string scheme() const override { return std::string(camera_scheme::sim); }

  [[nodiscard]] Result<std::vector<CameraEntry>> list() override {
    std::vector<CameraEntry> entries;
    for (const auto& name : resource_names(ResourceKind::sensor)) {
      entries.push_back({.id = camera_id(camera_scheme::sim, name),
                         .vendor = "todbench",
                         .model = name,
                         .serial = "1",
                         .transport = "simulation",
                         .address = ""});
    }
    return entries;
  }

  [[nodiscard]] Result<std::unique_ptr<FrameSource>> open(const std::string& id) override {
    auto spec = load_sensor(camera_name(id, camera_scheme::sim).value_or(id));
    if (!spec) return tl::unexpected(with_code(ErrorCode::not_found, spec.error()));
    auto model = std::make_shared<const SensorModel>(*spec, full_plan(*spec, {}, {}), Accuracy::normal(), 1);
    return simulated_source(std::move(model), std::make_shared<SceneHolder>(empty_scene(2)), "1");
  }
};

/// Shows other contrasts than the set ones: those that a camera observed for them.
class RemappedTarget final : public Target {
 public:
  RemappedTarget(std::unique_ptr<Target> target, std::map<double, double> shown)
      : target_(std::move(target)), shown_(std::move(shown)) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return target_->capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    TargetState actual = state;
    if (const auto found = shown_.find(state.delta_t_k); found != shown_.end()) actual.delta_t_k = found->second;
    return target_->present(actual, stop);
  }
  [[nodiscard]] bool asks_again(const std::string& reason) override { return target_->asks_again(reason); }

 private:
  std::unique_ptr<Target> target_;
  std::map<double, double> shown_;
};

/// Largest relative difference of contrast between large and small triangles that a lag may cause: 0.3 % of S75.
constexpr double lag_share = 0.006;

/// The plates of a plan in their mountings, at the extreme contrasts.
std::vector<TargetState> requested_states(const LoadedPlan& loaded) {
  const TargetPlan& target = loaded.plan().target;
  std::vector<TargetState> states;
  std::vector<double> contrasts = target.delta_t_k;
  if (loaded.plan().schedule.kind == ScheduleKind::ramp)
    contrasts.push_back(loaded.plan().schedule.from_delta_t_k.value_or(contrasts.front()));
  const auto [least, most] = std::ranges::minmax(contrasts);
  for (const TargetPlate& plate : loaded.plates()) {
    for (const Mounting mounting : target.mountings) {
      for (const double delta_t_k : {least, most}) states.push_back({plate.name, mounting, delta_t_k, {0, 0}});
    }
  }
  for (const TargetPlate& plate : loaded.shown_plates())
    states.push_back({plate.name, target.mountings.front(), 0, {0, 0}});
  return states;
}

/// Whether the camera sends without requests. Recordings do not, and their end is not a loss.
bool free_running(const Plan& plan) {
  return !has_scheme(plan.camera.id, camera_scheme::file) && !has_scheme(plan.camera.id, camera_scheme::sim);
}

/// All settings that the plan writes into the camera.
std::map<std::string, std::string> settings_of(const CameraPlan& camera) {
  std::map<std::string, std::string> settings = camera.settings;
  if (!camera.frame_size.empty()) settings[frame_size_feature] = camera.frame_size;
  if (!camera.nuc_command.empty()) settings[nuc_command_feature] = camera.nuc_command;
  return settings;
}

Result<void> write_settings(FrameSource& camera, const std::map<std::string, std::string>& settings) {
  for (const auto& [feature, value] : settings) {
    auto done = camera.set(feature, value);
    if (!done) return fail("setting " + feature + " = " + value, done.error());
  }
  return {};
}

}  // namespace

std::optional<CameraLibrary> camera_library() {
#ifdef TODBENCH_WITH_ARAVIS
  const AravisVersion version = running_aravis();
  return CameraLibrary{"Aravis " + to_string(version), aravis_faults(version)};
#else
  return std::nullopt;
#endif
}

CameraRegistry camera_registry([[maybe_unused]] std::stop_token stop, [[maybe_unused]] const SayProgress& on_progress) {
  CameraRegistry registry;
#ifdef TODBENCH_WITH_ARAVIS
  for (const auto transport : {AravisTransport::gige_vision, AravisTransport::usb3_vision}) {
    registry.add(aravis_backend({.transport = transport, .stop = stop, .on_progress = on_progress}));
  }
#endif
#ifdef TODBENCH_WITH_USB
  registry.add(usb_backend());
#endif
#ifdef TODBENCH_WITH_V4L2
  registry.add(v4l2_backend());
#endif
  registry.add(recording_backend());
  registry.add(std::make_unique<SimulatedBackend>());
  return registry;
}

Result<std::unique_ptr<FrameSource>> open_when_there(const std::string& id, const CameraPatience& patience,
                                                     std::stop_token stop, const SayProgress& on_progress) {
  const auto deadline = std::chrono::steady_clock::now() + patience.longest;
  std::mutex mutex;
  std::condition_variable_any never;
  for (;;) {
    auto camera = camera_registry(stop, on_progress).open(id);
    const auto now = std::chrono::steady_clock::now();
    if (camera || camera.error().code != ErrorCode::not_found || now >= deadline) return camera;
    if (patience.on_waiting) patience.on_waiting(camera.error());
    std::unique_lock lock(mutex);
    never.wait_until(lock, stop, std::min(deadline, now + patience.between_attempts), [] { return false; });
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped while waiting for camera " + id);
  }
}

OpenedBench simulated_bench(std::shared_ptr<const SensorModel> model, const std::vector<TargetPlate>& plates,
                            double distance_m, std::map<double, double> shown_delta_t_k, SceneMotion motion,
                            const SimulatedSourceOptions& source) {
  PlateScene scene = empty_scene(distance_m);
  scene.motion = motion;
  scene.background_k = model->spec().scene_temperature_k;
  const auto holder = std::make_shared<SceneHolder>(scene);
  auto target = scene_target(holder, plates);
  if (!shown_delta_t_k.empty())
    target = std::make_unique<RemappedTarget>(std::move(target), std::move(shown_delta_t_k));
  OpenedBench bench;
  bench.camera = simulated_source(std::move(model), holder, "1", source);
  bench.target = std::move(target);
  bench.simulated = true;
  return bench;
}

Result<std::unique_ptr<Target>> open_target(const LoadedPlan& loaded, std::stop_token stop,
                                            const AskOperator& ask_operator, const OnTargetWait& on_wait) {
  const Plan& plan = loaded.plan();
  if (plan.target.kind == TargetKind::prompt) return prompt_target(ask_operator ? ask_operator : ask_at_terminal());
  if (plan.target.kind == TargetKind::display) {
    return open_display_target(
        {.plates = loaded.shown_plates(),
         .display = {.size_px = {plan.target.display_width_px, plan.target.display_height_px},
                     .pixel_mm = plan.target.display_pixel_mm},
         .span_k = plan.target.display_span_k,
         .tone = {.gamma = plan.target.display_gamma, .luminance = plan.target.display_luminance},
         .delta_t_k = plan.target.delta_t_k,
         .settle = std::chrono::milliseconds(static_cast<long>(1000 * plan.target.display_settle_s)),
         .description = "display: " + plan.target.display},
        plan.target.display);
  }
  ScpiTargetOptions options;
  options.black_body = plan.target.black_body;
  options.stage = plan.target.stage;
  options.black_body_table = loaded.parts().black_body;
  options.stage_table = loaded.parts().stage;
  options.settle_timeout = std::chrono::milliseconds(static_cast<long>(plan.target.settle_timeout_s * 1000));
  options.poll_interval = std::chrono::milliseconds(10);
  options.on_wait = on_wait;
  options.requested = requested_states(loaded);
  if (plan.target.contrast_settling_band_percent > 0)
    options.settling_band = plan.target.contrast_settling_band_percent / 100;
  if (plan.target.max_contrast_lag_s.value_or(0) > 0)
    options.max_relative_rate_per_s = lag_share / *plan.target.max_contrast_lag_s;
  if (plan.measures.absolute) options.temperatures_k = plan.measures.absolute_temperatures_k;
  return open_scpi_target(options, stop);
}

Result<OpenedBench> open_bench(const LoadedPlan& loaded, std::stop_token stop, const ExperimentHost& host,
                               const SayProgress& on_progress, const OnTargetWait& on_wait) {
  const Plan& plan = loaded.plan();
  BenchHostOptions hosting{.pause = host.pause};
  if (plan.target.kind == TargetKind::scene) {
    const auto sensor = camera_name(plan.camera.id, camera_scheme::sim);
    if (!sensor) {
      return fail(ErrorCode::invalid_input,
                  "a target of kind 'scene' needs a simulated camera 'sim:NAME'. For camera " + plan.camera.id +
                      " set [target] kind to 'scpi', 'prompt' or 'display'");
    }
    TODBENCH_TRY(auto spec, load_sensor(*sensor));
    TODBENCH_TRY(auto accuracy, accuracy_of(plan));
    // The camera has its own seed: with the seed of the twin, equal noise of both would cancel. The scene may move; at
    // rest the effects of motion are neutral.
    auto model =
        std::make_shared<const SensorModel>(spec, full_plan(spec, {}, {}, any_motion), accuracy, plan.seed + 1);
    auto bench = simulated_bench(std::move(model), loaded.shown_plates(), plan.target.distance_m, {});
    bench.host = bench_host(hosting);
    return bench;
  }
  if (plan.target.kind == TargetKind::display && camera_name(plan.camera.id, camera_scheme::sim)) {
    return fail(
        ErrorCode::invalid_input,
        "camera " + plan.camera.id + " is simulated and cannot observe a monitor: [target] kind must be 'scene'");
  }
  OpenedBench bench;
  auto camera = open_when_there(plan.camera.id, host.camera_patience, stop, on_progress);
  if (!camera) return tl::unexpected(camera.error());
  bench.camera = std::move(*camera);
  const auto settings = settings_of(plan.camera);
  if (auto written = write_settings(*bench.camera, settings); !written) {
    return fail("camera " + plan.camera.id, written.error());
  }
  auto warnings = check_written_settings(*bench.camera, plan.camera.settings);
  if (!warnings) return fail("camera " + plan.camera.id, warnings.error());
  bench.warnings = *std::move(warnings);
  if (free_running(plan)) hosting.frames_while_presenting = FramesWhilePresenting::take;
  if (free_running(plan) && plan.camera.reconnect_s > 0) {
    bench.patience = std::chrono::milliseconds(static_cast<long>(plan.camera.reconnect_s * 1000));
    auto returning = std::make_unique<ReconnectingSource>(
        std::move(bench.camera), [id = plan.camera.id] { return camera_registry().open(id); },
        ReconnectionOptions{.patience = bench.patience, .settings = settings});
    hosting.camera = returning.get();
    bench.camera = std::move(returning);
  }
  bench.host = bench_host(hosting);
  auto target = open_target(loaded, stop, host.ask_operator, on_wait);
  if (!target) return target_failure("opening the target", target.error());
  bench.target = std::move(*target);
  for (std::string& sentence : contradicted_instruments(plan.instruments, bench.target->capabilities().description)) {
    bench.warnings.push_back(std::move(sentence));
  }
  return bench;
}

}  // namespace todbench
