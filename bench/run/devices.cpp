#include "bench/run/devices.h"

#include <iostream>

#include "acquisition/recording/recording_backend.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/plan_options.h"
#include "bench/plan/resources.h"
#include "tod/instruments/prompt_target.h"
#include "tod/instruments/scpi_target.h"
#ifdef TODBENCH_WITH_ARAVIS
#include "acquisition/aravis/aravis_backend.h"
#endif
#ifdef TODBENCH_WITH_USB
#include "acquisition/usb/usb_backend.h"
#endif
#ifdef TODBENCH_WITH_V4L2
#include "acquisition/v4l2/v4l2_backend.h"
#endif

namespace todbench {
namespace {

constexpr std::string_view simulated_scheme = "sim:";

/// A scene without a plate: what a simulated camera sees when no target is connected to it.
PlateScene empty_scene(double distance_m) {
  PlateScene scene;
  scene.distance_m = distance_m;
  return scene;
}

/// Simulated sensors by name, "sim:sc2000", looking at an empty scene.
class SimulatedBackend final : public CameraBackend {
 public:
  [[nodiscard]] std::string scheme() const override { return "sim"; }

  [[nodiscard]] Result<std::vector<CameraEntry>> list() override {
    std::vector<CameraEntry> entries;
    for (const auto& name : resource_names(ResourceKind::sensor)) {
      entries.push_back({.id = "sim:" + name,
                         .vendor = "todbench",
                         .model = name,
                         .serial = "1",
                         .transport = "simulation",
                         .address = ""});
    }
    return entries;
  }

  [[nodiscard]] Result<std::unique_ptr<FrameSource>> open(const std::string& id) override {
    auto spec = load_sensor(std::string_view(id).substr(simulated_scheme.size()));
    if (!spec) return tl::unexpected(with_code(ErrorCode::not_found, spec.error()));
    auto model = std::make_shared<const SensorModel>(*spec, full_plan(*spec, {}, {}), Accuracy::normal(), 1);
    return simulated_source(std::move(model), std::make_shared<SceneHolder>(empty_scene(2)), "1");
  }
};

/// Shows other contrasts than it is told: those that a camera saw when it was told the same.
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

 private:
  std::unique_ptr<Target> target_;
  std::map<double, double> shown_;
};

TargetCapabilities times_of(const TargetPlan& plan) {
  TargetCapabilities times;
  times.plate_change_s = plan.plate_change_s;
  times.mounting_change_s = plan.mounting_change_s;
  times.contrast_change_s = plan.contrast_change_s;
  times.shift_change_s = plan.shift_change_s;
  return times;
}

Result<std::unique_ptr<Target>> open_target(const Plan& plan, std::stop_token stop,
                                            const OperatorDialogue& ask_operator) {
  if (plan.target.kind == TargetKind::prompt) {
    PromptTargetOptions options;
    options.times = times_of(plan.target);
    if (ask_operator) return dialogue_target(ask_operator, options);
    return prompt_target(std::cerr, descriptor_lines(0), options);
  }
  ScpiTargetOptions options;
  options.black_body = plan.target.black_body;
  options.stage = plan.target.stage;
  options.settle_timeout = std::chrono::milliseconds(static_cast<long>(plan.target.settle_timeout_s * 1000));
  options.poll_interval = std::chrono::milliseconds(10);
  options.times = times_of(plan.target);
  return open_scpi_target(options, stop);
}

/// A camera that sends whether it is asked or not. Neither is a recording, nor is its end a loss.
bool free_running(const Plan& plan) {
  return !plan.camera.id.starts_with("file:") && !plan.camera.id.starts_with(simulated_scheme);
}

Result<void> write_settings(FrameSource& camera, const std::map<std::string, std::string>& settings) {
  for (const auto& [feature, value] : settings) {
    auto done = camera.set(feature, value);
    if (!done) return fail("setting " + feature + " = " + value, done.error());
  }
  return {};
}

}  // namespace

void let_camera_come_back(OpenedBench& bench, ReopenCamera reopen, ReconnectionOptions options) {
  const auto patience = options.patience;
  auto camera = std::make_unique<ReconnectingSource>(std::move(bench.camera), std::move(reopen), std::move(options));
  bench.camera_return = {.patience = patience,
                         .recover = [source = camera.get()](std::stop_token stop) { return source->recover(stop); },
                         .confirm = [source = camera.get()] { source->confirm_registration(); }};
  bench.camera = std::move(camera);
}

CameraRegistry camera_registry() {
  CameraRegistry registry;
#ifdef TODBENCH_WITH_ARAVIS
  registry.add(aravis_backend());
  registry.add(aravis_backend({.transport = AravisTransport::usb3_vision}));
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

OpenedBench simulated_bench(std::shared_ptr<const SensorModel> model, const std::vector<TargetPlate>& plates,
                            double distance_m, std::map<double, double> shown_delta_t_k, SceneMotion motion) {
  PlateScene scene = empty_scene(distance_m);
  scene.motion = motion;
  scene.background_k = model->spec().scene_temperature_k;
  const auto holder = std::make_shared<SceneHolder>(scene);
  auto target = scene_target(holder, plates);
  if (!shown_delta_t_k.empty())
    target = std::make_unique<RemappedTarget>(std::move(target), std::move(shown_delta_t_k));
  return {.camera = simulated_source(std::move(model), holder, "1"), .target = std::move(target), .simulated = true};
}

Result<OpenedBench> open_bench(const Plan& plan, const std::vector<TargetPlate>& plates, std::stop_token stop,
                               const OperatorDialogue& ask_operator) {
  if (plan.target.kind == TargetKind::scene) {
    if (!plan.camera.id.starts_with(simulated_scheme)) {
      return fail(ErrorCode::invalid_input,
                  "a target of kind 'scene' is the simulated scene of a camera 'sim:NAME'; camera " + plan.camera.id +
                      " needs kind 'scpi' or 'prompt'");
    }
    auto spec = load_sensor(std::string_view(plan.camera.id).substr(simulated_scheme.size()));
    if (!spec) return tl::unexpected(spec.error());
    auto accuracy = accuracy_of(plan);
    if (!accuracy) return tl::unexpected(accuracy.error());
    auto model = std::make_shared<const SensorModel>(*spec, full_plan(*spec, {}, {}), *accuracy, plan.seed);
    return simulated_bench(std::move(model), plates, plan.target.distance_m, {});
  }
  OpenedBench bench;
  auto camera = camera_registry().open(plan.camera.id);
  if (!camera) return tl::unexpected(camera.error());
  bench.camera = std::move(*camera);
  if (auto written = write_settings(*bench.camera, plan.camera.settings); !written) {
    return fail("camera " + plan.camera.id, written.error());
  }
  if (free_running(plan)) bench.frames_while_presenting = FramesMeanwhile::take;
  if (free_running(plan) && plan.camera.reconnect_s > 0) {
    let_camera_come_back(bench, [id = plan.camera.id] { return camera_registry().open(id); },
                         {.patience = std::chrono::milliseconds(static_cast<long>(plan.camera.reconnect_s * 1000)),
                          .settings = plan.camera.settings});
  }
  auto target = open_target(plan, stop, ask_operator);
  if (!target) return fail("opening the target", target.error());
  bench.target = std::move(*target);
  return bench;
}

}  // namespace todbench
