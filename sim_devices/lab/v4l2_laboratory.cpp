// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/v4l2_laboratory.h"

#include "acquisition/v4l2/video_listing.h"
#include "sim_devices/lab/video/v4l2_camera.h"

namespace todbench {
namespace {

class V4l2LaboratoryCamera final : public LaboratoryCamera {
 public:
  V4l2LaboratoryCamera(std::shared_ptr<MockSystem> system, std::unique_ptr<EmulatedV4l2Camera> camera)
      : system_(std::move(system)), camera_(std::move(camera)) {}

  [[nodiscard]] std::string id() const override {
    const VideoCameraConfig& config = camera_->config();
    VideoNode node;
    node.vendor = config.vendor;
    node.model = config.model;
    node.serial = config.serial;
    return video_id(node);
  }
  [[nodiscard]] std::string address() const override { return camera_->node(); }
  [[nodiscard]] std::map<std::string, std::string> client_environment() const override {
    return {{"LD_PRELOAD", MockSystem::preload_library()}, {"UMOCKDEV_DIR", system_->folder()}};
  }

 private:
  std::shared_ptr<MockSystem> system_;
  std::unique_ptr<EmulatedV4l2Camera> camera_;
};

}  // namespace

SensorSpec with_counts_of(VideoCameraKind kind, SensorSpec sensor) {
  const double scale = kelvin_per_count(kind);
  if (scale > 0) {
    sensor.kelvin_per_count = scale;
    sensor.offset_k = 0;
  }
  sensor.bits = significant_bits(kind);
  return sensor;
}

ConnectCamera connect_v4l2(std::shared_ptr<MockSystem> system, VideoCameraConfig config) {
  return
      [system = std::move(system), config](
          const SensorSpec& sensor, LaboratoryExposure exposure) mutable -> Result<std::unique_ptr<LaboratoryCamera>> {
        config.width = sensor.width * sensor.microscan;
        config.height = sensor.height * sensor.microscan;
        config.frame_rate_hz = sensor.frame_rate_hz;
        auto camera = EmulatedV4l2Camera::start(system, config, std::move(exposure));
        if (!camera) return fail("starting the emulated V4L2 camera", camera.error());
        return std::make_unique<V4l2LaboratoryCamera>(system, std::move(*camera));
      };
}

}  // namespace todbench
