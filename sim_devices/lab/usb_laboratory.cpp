// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/usb_laboratory.h"

#include "acquisition/base/try.h"
#include "acquisition/core/camera_id.h"
#include "acquisition/core/control_text.h"
#include "sim_devices/lab/usb/usbfs_host.h"

namespace todbench {
namespace {

class UsbLaboratoryCamera final : public LaboratoryCamera {
 public:
  UsbLaboratoryCamera(std::shared_ptr<MockSystem> system, std::unique_ptr<PluggedUsbDevice> port, std::string id,
                      std::map<std::string, std::string> settings)
      : system_(std::move(system)), port_(std::move(port)), id_(std::move(id)), settings_(std::move(settings)) {}

  [[nodiscard]] std::string id() const override { return id_; }
  [[nodiscard]] std::string address() const override { return port_->node(); }
  [[nodiscard]] std::map<std::string, std::string> settings() const override { return settings_; }
  [[nodiscard]] std::map<std::string, std::string> client_environment() const override {
    return {{"LD_PRELOAD", MockSystem::preload_library()}, {"UMOCKDEV_DIR", system_->folder()}};
  }

 private:
  std::shared_ptr<MockSystem> system_;
  std::unique_ptr<PluggedUsbDevice> port_;
  std::string id_;
  std::map<std::string, std::string> settings_;
};

Result<std::unique_ptr<LaboratoryCamera>> plugged(std::shared_ptr<MockSystem> system, std::shared_ptr<UsbDevice> device,
                                                  std::string id, std::map<std::string, std::string> settings) {
  TODBENCH_TRY(auto port, PluggedUsbDevice::plug(system, std::move(device)));
  return std::make_unique<UsbLaboratoryCamera>(std::move(system), std::move(port), std::move(id), std::move(settings));
}

}  // namespace

ConnectCamera connect_u3v(std::shared_ptr<MockSystem> system, U3vCameraConfig config) {
  return [system = std::move(system), config](
             const SensorSpec& sensor, LaboratoryExposure exposure) -> Result<std::unique_ptr<LaboratoryCamera>> {
    TODBENCH_TRY(auto camera, U3vCamera::create(as_sensor(config, sensor), std::move(exposure)));
    return plugged(system, std::move(camera), camera_id(camera_scheme::u3v, {config.vendor, config.serial}), {});
  };
}

ConnectCamera connect_seek(std::shared_ptr<MockSystem> system, SeekCameraConfig config) {
  return
      [system = std::move(system), config](
          const SensorSpec& sensor, LaboratoryExposure exposure) mutable -> Result<std::unique_ptr<LaboratoryCamera>> {
        const cv::Size size = geometry(config.model).picture.size();
        if (sensor.width * sensor.microscan != size.width || sensor.height * sensor.microscan != size.height ||
            sensor.bits > 14) {
          return fail(ErrorCode::invalid_input, "a Seek " + std::string(to_string(config.model)) + " has " +
                                                    std::to_string(size.width) + " x " + std::to_string(size.height) +
                                                    " pixels of 14 bits; the sensor " + sensor.name +
                                                    " has another size or more bits");
        }
        config.frame_rate_hz = sensor.frame_rate_hz;
        TODBENCH_TRY(auto camera, SeekCamera::create(config, std::move(exposure)));
        return plugged(system, std::move(camera), seek_camera_id(config.model, config.serial),
                       {{"TemperatureLinearScale", control_text(sensor.kelvin_per_count)},
                        {"TemperatureLinearOffset", control_text(sensor.offset_k)}});
      };
}

}  // namespace todbench
