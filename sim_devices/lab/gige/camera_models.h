// SPDX-License-Identifier: GPL-3.0-or-later
// Models of the GigE Vision emulation: registers, features, and effect of the features on the picture.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "sim_devices/lab/genicam/thermal_features.h"

namespace todbench {

/// Model of a camera.
enum class CameraModel {
  ax5,       ///< FLIR A5 ... A65: TemperatureLinearMode, CMOSBitDepth, NUCMode, test ramp, rates by video standard
  a_series,  ///< FLIR A3xx ... A700: IRFormat, NoiseReduction, AcquisitionFrameRate
  legacy_science,  ///< FLIR A305sc and A320G: Mono16 with the high byte first, which no feature states
  unlisted,        ///< an unknown vendor: raw counts, and a shutter feature with a non-standard name
};

/// Returns the name of the model.
[[nodiscard]] std::string_view to_string(CameraModel model);
/// Returns the model of "ax5", "a-series", "legacy-science" or "unlisted"; empty for other names.
[[nodiscard]] std::optional<CameraModel> camera_model(std::string_view name);

/// Addresses of the registers that the emulation reads; 0 if the model does not have the register.
struct ModelRegisters {
  std::uint32_t width = 0, height = 0, pixel_format = 0, payload_size = 0;
  std::uint32_t acquisition_start = 0, acquisition_stop = 0;
  std::uint32_t temperature_linear_mode = 0, temperature_linear_resolution = 0;  ///< registers of the Ax5
  std::uint32_t ir_format = 0;                                                   ///< register of the A series
  std::uint32_t video_standard = 0;                                              ///< Ax5 enumeration
  std::uint32_t image_adjust = 0;  ///< Ax5 enumeration ImageAdjustMethod: 1 is Linear
  std::uint32_t test_pattern = 0;
  std::uint32_t noise_reduction = 0;
  std::uint32_t nuc_mode = 0, nuc_action = 0, nuc_action_long = 0;
  std::uint32_t nuc_mode_automatic = 0;  ///< not an address: value of the register nuc_mode for automatic corrections
  std::uint32_t sensor_temperature = 0;  ///< raw / 10 in degrees Celsius
  std::uint32_t chunk_mode = 0;
  std::uint32_t largest_count = 0;
};

/// Ids of the chunks after a frame, if chunk mode is on.
inline constexpr std::uint32_t chunk_image = 0x00000001;
inline constexpr std::uint32_t chunk_exposure = 0xA0000001;            ///< ChunkExposureIndex
inline constexpr std::uint32_t chunk_sensor_temperature = 0xA0000002;  ///< ChunkSensorTemperature, 0.1 degrees Celsius
inline constexpr std::uint32_t chunk_nuc_active = 0xA0000003;          ///< ChunkNUCActive

/// Description of a model with its registers.
struct ModelDescription {
  CameraDescription genicam;
  ModelRegisters registers;
};

/// Returns registers and features of a model. The name of the model's family replaces an empty vendor or model name.
[[nodiscard]] ModelDescription describe_camera(CameraModel model, const ThermalCameraOptions& options);

/// Returns the frames per second for a value of SensorVideoStandard of the Ax5; 0 for an unknown value.
[[nodiscard]] double video_standard_hz(std::uint32_t value);

}  // namespace todbench
