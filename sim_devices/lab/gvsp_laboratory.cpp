// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/gvsp_laboratory.h"

#include <map>
#include <string>
#include <utility>

#include "acquisition/core/camera_id.h"
#include "acquisition/core/control_text.h"
#include "sim_devices/lab/gige/camera_models.h"

namespace todbench {
namespace {

class GvspLaboratoryCamera final : public LaboratoryCamera {
 public:
  explicit GvspLaboratoryCamera(std::unique_ptr<GvspCamera> camera) : camera_(std::move(camera)) {}

  [[nodiscard]] std::string id() const override {
    const GvspCameraConfig& config = camera_->config();
    const auto description = describe_camera(
        config.model, {.vendor = config.vendor, .model = config.model_name, .serial = {}, .firmware = {}});
    return camera_id(camera_scheme::gige, {description.genicam.vendor, config.serial});
  }
  [[nodiscard]] std::string address() const override { return camera_->config().interface_address; }
  [[nodiscard]] std::map<std::string, std::string> settings() const override {
    const GvspCameraConfig& config = camera_->config();
    if (config.model != CameraModel::unlisted) return {};
    // This model does not report its temperature scale.
    return {{"TemperatureLinearScale", control_text(config.kelvin_per_count)},
            {"TemperatureLinearOffset", control_text(config.offset_k)}};
  }

 private:
  std::unique_ptr<GvspCamera> camera_;
};

}  // namespace

SensorSpec with_counts_of(CameraModel model, SensorSpec sensor) {
  if (model == CameraModel::unlisted) return sensor;
  sensor.kelvin_per_count = model == CameraModel::ax5 ? 0.04 : 0.01;
  sensor.offset_k = 0;
  sensor.bits = model == CameraModel::ax5 ? 14 : 16;
  return sensor;
}

ConnectCamera connect_gvsp(GvspCameraConfig config) {
  return [config = std::move(config)](const SensorSpec& sensor,
                                      LaboratoryExposure exposure) -> Result<std::unique_ptr<LaboratoryCamera>> {
    auto camera = GvspCamera::start(as_sensor(config, sensor), std::move(exposure));
    if (!camera) return fail("starting the emulated GigE camera", camera.error());
    return std::make_unique<GvspLaboratoryCamera>(std::move(*camera));
  };
}

}  // namespace todbench
