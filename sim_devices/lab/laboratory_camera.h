// SPDX-License-Identifier: GPL-3.0-or-later
// Interface of a camera for the emulated laboratory, for any transport.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "acquisition/base/result.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Emulated camera that serves clients during its lifetime. Destroying the camera acts like pulling its cable, without
/// notice to a client.
class LaboratoryCamera {
 public:
  virtual ~LaboratoryCamera() = default;
  LaboratoryCamera() = default;
  LaboratoryCamera(const LaboratoryCamera&) = delete;
  LaboratoryCamera& operator=(const LaboratoryCamera&) = delete;

  /// Returns the identifier for the plan: "gige:VENDOR-SERIAL".
  [[nodiscard]] virtual std::string id() const = 0;
  /// Returns the IPv4 address or device node.
  [[nodiscard]] virtual std::string address() const = 0;
  /// Returns the settings that a plan must state because the camera does not report them.
  [[nodiscard]] virtual std::map<std::string, std::string> settings() const { return {}; }
  /// Returns the environment variables for a client in another process; empty: none.
  [[nodiscard]] virtual std::map<std::string, std::string> client_environment() const { return {}; }
};

/// Returns picture number `index` since power-up, with the geometry of the sensor.
using LaboratoryExposure = std::function<cv::Mat1w(std::uint64_t index)>;

/// Returns the configuration of an emulated camera with the geometry, rate and scale of a sensor.
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

/// Function that switches on a camera that sends the exposures of a sensor.
using ConnectCamera =
    std::function<Result<std::unique_ptr<LaboratoryCamera>>(const SensorSpec& sensor, LaboratoryExposure exposure)>;

}  // namespace todbench
