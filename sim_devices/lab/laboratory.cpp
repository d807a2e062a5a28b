#include "sim_devices/lab/laboratory.h"

#include <algorithm>

#include "acquisition/aravis/aravis_backend.h"

namespace todbench {

struct Laboratory::State {
  LaboratoryOptions options;
  std::unique_ptr<SensorModel> model;
  std::unique_ptr<BlackBody> black_body;
  std::unique_ptr<PlateStage> stage;
  std::unique_ptr<EmulatedGigeCamera> camera;  // last: its thread looks at the others

  [[nodiscard]] PlateScene scene() const {
    const PlateStageState on_stage = stage->state();
    const BlackBodyState heat = black_body->state();
    const auto plate = std::find_if(options.plates.begin(), options.plates.end(),
                                    [&](const TargetPlate& p) { return p.name == on_stage.plate; });
    PlateScene scene;
    if (plate != options.plates.end()) scene.plate = mounted(*plate, on_stage.mounting);
    scene.delta_t_k = heat.delta_t_k;
    scene.background_k = heat.plate_temperature_k;
    scene.distance_m = options.distance_m;
    scene.shift_mm = on_stage.shift_mm;
    scene.centre_px = options.centre_px;
    scene.rotation_deg = options.rotation_deg;
    return scene;
  }
};

Laboratory::Laboratory(std::unique_ptr<State> state) : state_(std::move(state)) {}
Laboratory::~Laboratory() = default;

Result<std::unique_ptr<Laboratory>> Laboratory::start(LaboratoryOptions options) {
  if (options.plates.empty()) return fail(ErrorCode::invalid_input, "the emulated laboratory needs a plate");
  auto state = std::make_unique<State>();
  state->options = std::move(options);
  LaboratoryOptions& o = state->options;
  state->model = std::make_unique<SensorModel>(o.sensor, o.plan, o.accuracy, o.seed);

  auto black_body = BlackBody::start(o.black_body);
  if (!black_body) return tl::unexpected(black_body.error());
  state->black_body = std::move(*black_body);

  o.stage.plates.clear();
  for (const auto& plate : o.plates) o.stage.plates.push_back(plate.name);
  auto stage = PlateStage::start(o.stage);
  if (!stage) return tl::unexpected(stage.error());
  state->stage = std::move(*stage);

  o.camera.width = state->model->size().width;
  o.camera.height = state->model->size().height;
  o.camera.significant_bits = o.sensor.bits;
  o.camera.frame_rate_hz = o.sensor.frame_rate_hz;
  o.camera.kelvin_per_count = o.sensor.kelvin_per_count;
  o.camera.offset_k = o.sensor.offset_k;
  // Frame k shows what is before the camera at that moment, with the noise of exposure k.
  auto camera = EmulatedGigeCamera::start(
      o.camera, [seen = state.get()](std::uint64_t index) { return seen->model->expose(seen->scene(), index); });
  if (!camera) return fail("starting the emulated GigE camera", camera.error());
  state->camera = std::move(*camera);
  return std::unique_ptr<Laboratory>(new Laboratory(std::move(state)));
}

std::string Laboratory::camera_id() const {
  return todbench::camera_id("gige", state_->options.camera.vendor, state_->options.camera.serial);
}
std::string Laboratory::camera_address() const {
  return state_->options.camera.interface_address;
}
std::string Laboratory::black_body_endpoint() const {
  return state_->black_body->endpoint();
}
std::string Laboratory::stage_endpoint() const {
  return state_->stage->endpoint();
}
PlateScene Laboratory::scene() const {
  return state_->scene();
}
const SensorModel& Laboratory::model() const {
  return *state_->model;
}
EmulatedGigeCamera& Laboratory::camera() {
  return *state_->camera;
}
void Laboratory::switch_camera_off() {
  state_->camera.reset();
}

}  // namespace todbench
