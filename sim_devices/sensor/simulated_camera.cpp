// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/simulated_camera.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "acquisition/base/host_clock.h"
#include "acquisition/base/try.h"
#include "acquisition/core/camera_id.h"
#include "sim_devices/sensor/moving_scene.h"
#include "sim_devices/sensor/super_resolution_stage.h"

namespace todbench {
namespace {

class SimulatedSource final : public FrameSource {
 public:
  SimulatedSource(std::shared_ptr<const SensorModel> model, std::shared_ptr<SceneHolder> scene, std::string serial,
                  const SimulatedSourceOptions& options)
      : model_(std::move(model)), scene_(std::move(scene)), dither_(options.dither) {
    const SensorSpec& spec = model_->spec();
    if (sensor_module(spec) != nullptr) module_.emplace(spec, model_->seed(), options.on_error_line);
    const auto scale = RadiometricScale::linear({.kelvin_per_count = spec.kelvin_per_count, .offset_k = spec.offset_k});
    CV_Assert(scale.has_value());
    scale_ = std::make_shared<const RadiometricScale>(*scale);
    info_.id = camera_id(camera_scheme::sim, spec.name);
    info_.vendor = "todbench";
    info_.model = spec.name;
    info_.serial = std::move(serial);
    info_.firmware = "simulation";
    info_.transport = "simulation";
    info_.width = model_->size().width;
    info_.height = model_->size().height;
    info_.pixel_format = spec.bits <= 8 ? "Mono8" : "Mono" + std::to_string(spec.bits);
    info_.significant_bits = spec.bits;
    info_.frame_rate_hz = spec.frame_rate_hz;
    info_.scale = *scale_;
  }

  [[nodiscard]] const SourceInfo& info() const override { return info_; }

  [[nodiscard]] Result<void> start() override {
    stopped_ = false;
    return {};
  }

  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds /*timeout*/) override {
    if (stopped_) return fail(ErrorCode::interrupted, "simulated camera " + info_.id + " is stopped");
    Frame frame;
    const double time_s = static_cast<double>(index_) / info_.frame_rate_hz;
    PlateScene scene = scene_->scene_at(time_s, model_->spec());
    if (dither_ > 1) scene.centre_px += dither_px(dither_, index_);
    if (module_) {
      TODBENCH_TRY(frame.counts, module_->expose(scene, index_));
    } else {
      frame.counts = model_->expose(scene, index_);
    }
    frame.sequence = index_;
    // The simulated clock ticks once per exposure, so that a run repeats bit for bit.
    frame.device_time_ns = static_cast<std::int64_t>(static_cast<double>(index_) * 1e9 / info_.frame_rate_hz);
    frame.host_time_ns = monotonic_ns();
    frame.significant_bits = info_.significant_bits;
    frame.scale = scale_;
    // It has none. Strong noise of rows looks like one, and the wait after it would never end: it is in time of the
    // host, in which a fast simulation makes many more frames.
    frame.correction = CorrectionState::idle;
    ++index_;
    return frame;
  }

  void stop() override { stopped_ = true; }

  [[nodiscard]] Result<std::string> get(const std::string& feature) override {
    if (feature == "DeviceSerialNumber") return info_.serial;
    if (feature == "DeviceModelName") return info_.model;
    if (feature == "PixelFormat") return info_.pixel_format;
    if (feature == "Width") return std::to_string(info_.width);
    if (feature == "Height") return std::to_string(info_.height);
    return fail(ErrorCode::invalid_input, "simulated camera has no feature '" + feature + "'");
  }

  [[nodiscard]] Result<void> set(const std::string& feature, const std::string& /*value*/) override {
    return fail(ErrorCode::invalid_input, "simulated camera has no settable feature '" + feature + "'");
  }

  [[nodiscard]] Result<void> correct_nonuniformity() override { return {}; }

 private:
  std::shared_ptr<const SensorModel> model_;
  std::shared_ptr<SceneHolder> scene_;
  std::optional<ModuleSensor> module_;
  int dither_;
  std::shared_ptr<const RadiometricScale> scale_;
  SourceInfo info_;
  std::uint64_t index_ = 0;
  std::atomic<bool> stopped_{true};
};

class SceneTarget final : public Target, private MovingTarget, private SteppingTarget {
 public:
  SceneTarget(std::shared_ptr<SceneHolder> scene, std::vector<TargetPlate> plates)
      : scene_(std::move(scene)), plates_(std::move(plates)) {
    capabilities_.description = "simulated scene";
    capabilities_.sets_shift = true;
  }

  [[nodiscard]] const TargetCapabilities& capabilities() const override { return capabilities_; }

  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped before the target was presented");
    const auto plate =
        std::find_if(plates_.begin(), plates_.end(), [&](const TargetPlate& p) { return p.name == state.plate; });
    if (plate == plates_.end())
      return fail(ErrorCode::invalid_input, "the simulated scene has no plate '" + state.plate + "'");
    PlateScene scene = *scene_->scene();
    scene.plate = mounted(*plate, state.mounting);
    scene.delta_t_k = state.delta_t_k;
    scene.shift_mm = state.shift_mm;
    scene_->set(scene);
    return PresentedTarget{.state = state,
                           .plate_temperature_k = scene.background_k,
                           .black_body_temperature_k = scene.background_k + state.delta_t_k,
                           .settling_s = 0};
  }

  [[nodiscard]] MovingTarget* moving() override { return this; }
  [[nodiscard]] SteppingTarget* stepping() override { return this; }

 private:
  [[nodiscard]] Result<void> step_to(double delta_t_k, std::stop_token stop) override {
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped before the contrast step");
    if (!std::isfinite(delta_t_k))
      return fail(ErrorCode::invalid_input, "the simulated scene needs a finite contrast to step to");
    scene_->step_to(delta_t_k);
    return {};
  }
  [[nodiscard]] Result<std::array<double, 2>> run_speeds_mm_s(std::stop_token) override {
    return std::array{1e-6, 1e6};
  }
  [[nodiscard]] Result<PlateRun> run_along_x(double to_mm, double speed_mm_s, std::stop_token stop) override {
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped before the plate moved");
    // Written so that NaN fails.
    if (!(speed_mm_s > 0) || !std::isfinite(to_mm) || to_mm == scene_->scene()->shift_mm.x)
      return fail(ErrorCode::invalid_input, "the simulated plate needs a speed above 0 and another finite position");
    return scene_->run_along_x(to_mm, speed_mm_s);
  }

  std::shared_ptr<SceneHolder> scene_;
  std::vector<TargetPlate> plates_;
  TargetCapabilities capabilities_;
};

}  // namespace

SceneHolder::SceneHolder(PlateScene scene) : scene_(std::make_shared<const PlateScene>(std::move(scene))) {}

std::shared_ptr<const PlateScene> SceneHolder::scene() const {
  const std::scoped_lock lock(mutex_);
  return scene_;
}

void SceneHolder::set(PlateScene scene) {
  auto next = std::make_shared<const PlateScene>(std::move(scene));
  const std::scoped_lock lock(mutex_);
  scene_ = std::move(next);
  run_.reset();
  steps_.reset();
  steps_next_ = false;
}

void SceneHolder::step_to(double delta_t_k) {
  const std::scoped_lock lock(mutex_);
  PlateScene next = *scene_;
  if (!steps_) steps_.emplace(next.delta_t_k);
  next.delta_t_k = delta_t_k;
  scene_ = std::make_shared<const PlateScene>(std::move(next));
  steps_next_ = true;
}

PlateScene SceneHolder::scene_at(double time_s, const SensorSpec& spec) {
  const std::scoped_lock lock(mutex_);
  if (steps_next_) {
    // Multiples of the golden ratio spread the steps over all phases of the frame.
    const double phase = std::fmod(0.5 + 0.6180339887498949 * steps_made_++, 1);
    steps_->step(time_s_ + phase * (time_s - time_s_), scene_->delta_t_k);
    steps_next_ = false;
  }
  time_s_ = time_s;
  if (!run_ && !steps_) return *scene_;
  PlateScene scene = *scene_;
  if (steps_) scene.delta_t_k = steps_->seen_k(time_s, spec);
  if (!run_) return scene;
  const double gone_s = time_s - *run_->start_s;
  scene.shift_mm.x =
      gone_s < run_->duration_s() ? run_->from_mm + run_->direction() * run_->speed_mm_s * gone_s : run_->to_mm;
  return in_motion(std::move(scene), gone_s < run_->duration_s() ? run_->direction() * run_->speed_mm_s : 0, spec);
}

PlateRun SceneHolder::run_along_x(double to_mm, double speed_mm_s) {
  const std::scoped_lock lock(mutex_);
  run_ = PlateRun{.from_mm = scene_->shift_mm.x, .to_mm = to_mm, .speed_mm_s = speed_mm_s, .start_s = time_s_};
  return *run_;
}

std::unique_ptr<FrameSource> simulated_source(std::shared_ptr<const SensorModel> model,
                                              std::shared_ptr<SceneHolder> scene, std::string serial,
                                              const SimulatedSourceOptions& options) {
  return std::make_unique<SimulatedSource>(std::move(model), std::move(scene), std::move(serial), options);
}

std::unique_ptr<Target> scene_target(std::shared_ptr<SceneHolder> scene, std::vector<TargetPlate> plates) {
  return std::make_unique<SceneTarget>(std::move(scene), std::move(plates));
}

}  // namespace todbench
