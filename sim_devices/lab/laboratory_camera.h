// What the emulated laboratory needs of a camera, whatever interface it is on.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "acquisition/core/result.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// An emulated camera that serves while it lives; destroyed without a word to its client, as a pulled cable does.
class LaboratoryCamera {
 public:
  virtual ~LaboratoryCamera() = default;
  LaboratoryCamera() = default;
  LaboratoryCamera(const LaboratoryCamera&) = delete;
  LaboratoryCamera& operator=(const LaboratoryCamera&) = delete;

  /// For the plan: "gige:VENDOR-SERIAL".
  [[nodiscard]] virtual std::string id() const = 0;
  /// Where it is: an IPv4 address, a device node.
  [[nodiscard]] virtual std::string address() const = 0;
  /// What a plan has to state, because the camera does not say it itself.
  [[nodiscard]] virtual std::map<std::string, std::string> settings() const { return {}; }
  /// What the environment of a client in another process has to be; empty: nothing special.
  [[nodiscard]] virtual std::map<std::string, std::string> client_environment() const { return {}; }
};

/// Picture number `index` since power-up, of the geometry of the sensor.
using LaboratoryExposure = std::function<cv::Mat1w(std::uint64_t index)>;

/// The configuration of an emulated camera with the geometry, rate and scale of a sensor.
template <typename Config>
[[nodiscard]] Config as_sensor(Config config, const SensorSpec& sensor) {
  config.width = sensor.width * sensor.microscan;
  config.height = sensor.height * sensor.microscan;
  config.significant_bits = sensor.bits;
  config.frame_rate_hz = sensor.frame_rate_hz;
  config.kelvin_per_count = sensor.kelvin_per_count;
  config.offset_k = sensor.offset_k;
  return config;
}

/// Switches a camera on that sends what a sensor exposes.
using ConnectCamera =
    std::function<Result<std::unique_ptr<LaboratoryCamera>>(const SensorSpec& sensor, LaboratoryExposure exposure)>;

}  // namespace todbench
