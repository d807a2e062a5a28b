// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/laboratory.h"

#include <algorithm>
#include <atomic>
#include <optional>

#include "acquisition/base/rng.h"
#include "acquisition/base/try.h"
#include "acquisition/core/camera_id.h"
#include "sim_devices/atmosphere/mirror_radiance.h"
#include "sim_devices/sensor/contrast_steps.h"
#include "sim_devices/sensor/moving_scene.h"

namespace todbench {

namespace {

class GigeLaboratoryCamera final : public LaboratoryCamera {
 public:
  explicit GigeLaboratoryCamera(std::unique_ptr<EmulatedGigeCamera> camera) : camera_(std::move(camera)) {}
  [[nodiscard]] std::string id() const override {
    return todbench::camera_id(camera_scheme::gige, {camera_->config().vendor, camera_->config().serial});
  }
  [[nodiscard]] std::string address() const override { return camera_->config().interface_address; }

 private:
  std::unique_ptr<EmulatedGigeCamera> camera_;
};

ConnectCamera connect_gige(const EmulatedGigeCameraConfig& config, EmulatedGigeCamera::NucObserver on_nuc) {
  return [config, on_nuc = std::move(on_nuc)](
             const SensorSpec& sensor, LaboratoryExposure exposure) -> Result<std::unique_ptr<LaboratoryCamera>> {
    auto camera = EmulatedGigeCamera::start(as_sensor(config, sensor), std::move(exposure), on_nuc);
    if (!camera) return fail("starting the emulated GigE camera", camera.error());
    return std::make_unique<GigeLaboratoryCamera>(std::move(*camera));
  };
}

/// The sensor as stated by a camera with an error of scale: stated over true kelvin is `scale`.
SensorSpec as_stated(SensorSpec sensor, double scale) {
  sensor.kelvin_per_count *= scale;
  sensor.offset_k = scale * sensor.offset_k + (1 - scale) * sensor.scene_temperature_k;
  return sensor;
}

}  // namespace

struct Laboratory::State {
  LaboratoryOptions options;
  std::unique_ptr<SensorModel> model;
  std::optional<MonitorView> monitor;
  std::unique_ptr<BlackBody> black_body;
  std::unique_ptr<PlateStage> stage;
  std::string camera_id, camera_address;
  std::map<std::string, std::string> camera_settings, client_environment;
  std::atomic<std::uint64_t> next_exposure = 0, since_power_up = 0;
  std::optional<ContrastSteps> taken_in{};      ///< contrast steps since power-up; used by the camera's thread
  std::atomic<std::uint64_t> corrected_at = 0;  ///< exposures since power-up at the last correction
  DriftPattern drifting;                        ///< pattern of the drift; empty: none
  std::unique_ptr<LaboratoryCamera> camera;     // last: its thread uses the other members

  /// Frame k shows the scene at that moment with the noise of exposure k.
  [[nodiscard]] Result<void> connect_camera() {
    corrected_at = 0;
    const LaboratoryExposure expose = [this, first = next_exposure.load()](std::uint64_t index) {
      next_exposure = first + index + 1;
      since_power_up = index + 1;
      if (monitor) return monitor->expose(first + index);
      PlateScene scene = scene_at(frame_time_s(index) - options.latency_s);
      scene.delta_t_k = taken_in_k(scene.delta_t_k, index);
      cv::Mat1w counts = exposed(scene, first + index, index);
      return options.sent_counts ? options.sent_counts(std::move(counts), scene) : counts;
    };
    TODBENCH_TRY(camera, options.connect(as_stated(options.sensor, options.stated_scale), expose));
    return {};
  }

  /// Adds the drift since the last correction.
  [[nodiscard]] cv::Mat1w exposed(PlateScene scene, std::uint64_t exposure, std::uint64_t index) const {
    if (!options.drift.any()) return model->expose(scene, exposure);
    const double frames = static_cast<double>(index) - static_cast<double>(corrected_at.load());
    const double minutes = options.drift.minutes(std::max(0.0, frames / options.sensor.frame_rate_hz));
    scene.background_k += options.drift.level_k_per_min * minutes;
    const cv::Mat1w counts = model->expose(scene, exposure);
    if (drifting.draw.empty()) return counts;
    return with_pattern(counts, drifting, options.drift.pattern_k_per_min * minutes, exposure, options.sensor);
  }

  /// Contrast that the detector has reached. It became `delta_t_k` at an unknown moment since the last exposure.
  [[nodiscard]] double taken_in_k(double delta_t_k, std::uint64_t index) {
    const double time_s = frame_time_s(index);
    if (!taken_in || index == 0) taken_in.emplace(delta_t_k);
    if (taken_in->last_k() != delta_t_k) {
      if (taken_in->over(time_s, options.sensor)) taken_in.emplace(taken_in->last_k());
      const double before = 1 - RandomStream(options.seed, "laboratory.step").uniform(index);
      taken_in->step(time_s - before / options.sensor.frame_rate_hz, delta_t_k);
    }
    return taken_in->seen_k(time_s, options.sensor);
  }

  /// Device time of an exposure since power-up. The camera's clock advances by one frame per exposure.
  [[nodiscard]] double frame_time_s(std::uint64_t index) const {
    return static_cast<double>(index + 1) / options.sensor.frame_rate_hz;
  }

  [[nodiscard]] PlateScene scene_at(double camera_time_s) const {
    const PlateStageState on_stage = stage->state_at(camera_time_s);
    const BlackBodyState heat = black_body->state();
    const auto plate = std::find_if(options.plates.begin(), options.plates.end(),
                                    [&](const TargetPlate& p) { return p.name == on_stage.plate; });
    PlateScene scene;
    if (plate != options.plates.end()) scene.plate = mounted(*plate, on_stage.mounting);
    const auto seen_k = [&](double source_k) {
      return seen_behind_mirrors_k({options.sensor.wavelength_min_um, options.sensor.wavelength_max_um},
                                   options.mirror_transmission, options.mirror_temperature_k, source_k);
    };
    scene.background_k = seen_k(heat.plate_temperature_k);
    scene.delta_t_k = options.mirror_transmission == 1
                          ? heat.delta_t_k
                          : seen_k(heat.plate_temperature_k + heat.delta_t_k) - scene.background_k;
    scene.distance_m = options.distance_m;
    const auto& real_place_mm = options.stage.real_place_mm;
    scene.shift_mm = real_place_mm ? real_place_mm(on_stage.shift_mm) : on_stage.shift_mm;
    scene.centre_px = options.centre_px;
    scene.rotation_deg = options.rotation_deg;
    return in_motion(std::move(scene), on_stage.speed_mm_per_s, model->spec());
  }
};

Laboratory::Laboratory(std::unique_ptr<State> state) : state_(std::move(state)) {}
Laboratory::~Laboratory() = default;

Result<std::unique_ptr<Laboratory>> Laboratory::start(LaboratoryOptions options) {
  if (options.plates.empty()) return fail(ErrorCode::invalid_input, "the emulated laboratory needs at least one plate");
  // Written so that NaN fails.
  if (!(options.mirror_transmission > 0 && options.mirror_transmission <= 1 && options.mirror_temperature_k > 0))
    return fail(ErrorCode::invalid_input, "the mirrors need a transmission above 0 and up to 1, and a temperature");
  if (!(options.stated_scale > 0)) return fail(ErrorCode::invalid_input, "the stated scale must be above 0");
  auto state = std::make_unique<State>();
  state->options = std::move(options);
  LaboratoryOptions& o = state->options;
  state->model = std::make_unique<SensorModel>(o.sensor, o.plan, o.accuracy, o.seed);

  if (o.monitor) {
    TODBENCH_TRY(state->monitor, MonitorView::make(*o.monitor, *state->model, o.accuracy, o.distance_m, o.centre_px));
  }

  TODBENCH_TRY(state->black_body, BlackBody::start(o.black_body));

  o.stage.plates.clear();
  for (const auto& plate : o.plates) o.stage.plates.push_back(plate.name);
  o.stage.camera_clock_s = [s = state.get()] { return s->frame_time_s(s->since_power_up); };
  TODBENCH_TRY(state->stage, PlateStage::start(o.stage));

  if (o.drift.pattern_k_per_min != 0) state->drifting = drift_pattern(state->model->size(), o.seed);
  if (!o.connect) o.connect = connect_gige(o.camera, [s = state.get()] { s->corrected_at = s->since_power_up.load(); });
  TODBENCH_TRY_VOID(state->connect_camera());
  state->camera_id = state->camera->id();
  state->camera_address = state->camera->address();
  state->camera_settings = state->camera->settings();
  state->client_environment = state->camera->client_environment();
  return std::unique_ptr<Laboratory>(new Laboratory(std::move(state)));
}

std::string Laboratory::camera_id() const {
  return state_->camera_id;
}
std::string Laboratory::camera_address() const {
  return state_->camera_address;
}
std::map<std::string, std::string> Laboratory::camera_settings() const {
  return state_->camera_settings;
}
std::map<std::string, std::string> Laboratory::client_environment() const {
  return state_->client_environment;
}
std::string Laboratory::black_body_endpoint() const {
  return state_->black_body->endpoint();
}
std::string Laboratory::stage_endpoint() const {
  return state_->stage->endpoint();
}
PlateScene Laboratory::scene() const {
  return state_->scene_at(state_->frame_time_s(state_->since_power_up));
}
const SensorModel& Laboratory::model() const {
  return *state_->model;
}
void Laboratory::switch_camera_off() {
  state_->camera.reset();
}
Result<void> Laboratory::switch_camera_on() {
  return state_->camera ? Result<void>() : state_->connect_camera();
}

}  // namespace todbench
