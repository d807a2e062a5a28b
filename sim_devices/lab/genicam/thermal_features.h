// SPDX-License-Identifier: GPL-3.0-or-later
// Features that the emulated GenICam cameras share, and a complete camera with these features for any interface.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/base/result.h"
#include "acquisition/pixel_formats/pixel_formats.h"
#include "sim_devices/lab/genicam/genicam_description.h"

namespace todbench {

/// Identity of an emulated camera, and contents of its registers at power-up.
struct ThermalCameraOptions {
  std::string vendor, model, serial, firmware;
  int width = 0, height = 0;
  int significant_bits = 14;
  double frame_rate_hz = 50;
  double kelvin_per_count = 0.01, offset_k = 0;
  std::optional<PixelFormat> only_format{};  ///< single pixel format in place of the formats of the model
};

/// Returns the options from the configuration of a camera.
template <typename Config>
[[nodiscard]] ThermalCameraOptions options_of(const Config& config) {
  return {.vendor = config.vendor,
          .model = config.model,
          .serial = config.serial,
          .firmware = config.firmware,
          .width = config.width,
          .height = config.height,
          .significant_bits = config.significant_bits,
          .frame_rate_hz = config.frame_rate_hz,
          .kelvin_per_count = config.kelvin_per_count,
          .offset_k = config.offset_k};
}

/// Builders of features. `address`: address of the register of the feature; `initial`: raw value at power-up.
namespace features {

using Entries = std::vector<std::pair<std::string, std::uint32_t>>;

/// Returns a text of `bytes` characters.
[[nodiscard]] CameraFeature text(const char* name, std::uint32_t address, std::uint32_t bytes, std::string content);
/// Returns an enumeration.
[[nodiscard]] CameraFeature choice(const char* name, std::uint32_t address, std::uint32_t initial, Entries entries);
/// Returns a command that is executed by writing `value`.
[[nodiscard]] CameraFeature command(const char* name, std::uint32_t address, std::uint32_t value);
/// Returns a read-only number.
[[nodiscard]] CameraFeature state(const char* name, std::uint32_t address, std::uint32_t initial);
/// Returns a read-only temperature in degrees Celsius.
[[nodiscard]] CameraFeature temperature(const char* name, std::uint32_t address, double per_raw, std::uint32_t raw);
/// Returns a read-only float.
[[nodiscard]] CameraFeature real(const char* name, std::uint32_t address, double value);
/// Returns PixelFormat with these formats; the first is chosen at power-up.
[[nodiscard]] CameraFeature pixel_format(std::uint32_t address, const std::vector<PixelFormat>& formats);
/// Returns PixelDynamicRangeMax, the largest count that the camera produces.
[[nodiscard]] CameraFeature largest_count(std::uint32_t address, int significant_bits);
/// Returns the feature, locked against writes while the camera streams.
[[nodiscard]] CameraFeature locked_while_streaming(CameraFeature feature);

}  // namespace features

/// Addresses of the registers of thermal_camera().
struct ThermalRegisters {
  std::uint32_t vendor = 0, model = 0, firmware = 0, serial = 0;
  std::uint32_t name_bytes = 0, serial_bytes = 0;  ///< lengths of the text registers in bytes
  std::uint32_t width = 0, height = 0, offset_x = 0, offset_y = 0, pixel_format = 0, largest_count = 0;
  std::uint32_t payload_size = 0, acquisition_mode = 0, acquisition = 0, period_us = 0;
  std::uint32_t ir_format = 0, linear_scale = 0, linear_offset = 0, nuc_mode = 0, nuc_action = 0;
};

/// Values of the register of IRFormat.
inline constexpr std::uint32_t ir_format_radiometric = 0, ir_format_100mk = 1, ir_format_10mk = 2;
/// Values of the register of NUCMode.
inline constexpr std::uint32_t nuc_mode_manual = 0, nuc_mode_automatic = 1;
/// Value of the register of AcquisitionMode.
inline constexpr std::uint32_t acquisition_continuous = 1;

/// Returns a camera with counts linear in temperature: geometry, Mono14 and Mono16, a free frame rate, IRFormat with
/// its two linear entries, and a correction on command. The categories are DeviceControl, ImageFormatControl,
/// AcquisitionControl and ThermalControl. A camera with more features appends them with more_of().
[[nodiscard]] CameraDescription thermal_camera(const ThermalRegisters& registers, const ThermalCameraOptions& options);

/// Returns the features of a category, to be extended. Adds the category if it does not exist.
[[nodiscard]] std::vector<CameraFeature>& more_of(CameraDescription& camera, const std::string& category);
/// Returns the feature with this name. Precondition: the description contains the feature.
[[nodiscard]] CameraFeature& feature_named(CameraDescription& camera, const std::string& name);

/// Checks the configuration of an emulated camera; `who` begins the message. Errors: `invalid_input`.
template <typename Config>
[[nodiscard]] Result<void> validate_emulation(const std::string& who, const Config& config) {
  const auto bad = [&](const char* what) { return fail(ErrorCode::invalid_input, who + ": " + what); };
  if (config.width < 1 || config.height < 1 || config.width > 4096 || config.height > 4096) {
    return bad("width and height must be 1 ... 4096");
  }
  if (config.significant_bits < 8 || config.significant_bits > 16) return bad("significant_bits must be 8 ... 16");
  if (!(config.frame_rate_hz >= least_rate_hz && config.frame_rate_hz <= most_rate_hz)) {
    return bad("frame_rate_hz must be 0.1 ... 1000");
  }
  if (!(config.kelvin_per_count > 0) || !std::isfinite(config.offset_k)) {
    return bad("kelvin_per_count must be positive");
  }
  if (config.serial.empty()) return bad("a serial number is needed");
  if (config.nuc_freeze_frames < 0) return bad("nuc_freeze_frames must not be negative");
  return {};
}

}  // namespace todbench
