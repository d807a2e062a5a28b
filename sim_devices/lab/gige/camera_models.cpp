// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/gige/camera_models.h"

#include <array>
#include <cmath>

#include "acquisition/aravis/gev_registers.h"

namespace todbench {
namespace {

using namespace features;
using Features = std::vector<CameraFeature>;
using Kind = FeatureKind;
constexpr auto read_only = FeatureAccess::read_only;

struct VideoStandard {
  const char* name;
  std::uint32_t value;
  double rate_hz;
};
constexpr std::array<VideoStandard, 4> video_standards{
    {{"NTSC30HZ", 0, 30}, {"PAL25Hz", 1, 25}, {"NTSC60HZ", 4, 60}, {"PAL50HZ", 5, 50}}};

std::uint32_t nearest_video_standard(double rate_hz) {
  VideoStandard best = video_standards.front();
  for (const auto& standard : video_standards) {
    if (std::abs(standard.rate_hz - rate_hz) < std::abs(best.rate_hz - rate_hz)) best = standard;
  }
  return best.value;
}

/// Strings of discovery as features.
Features device_control(const ThermalCameraOptions& o) {
  return {
      text("DeviceVendorName", gev::vendor_name, 32, o.vendor), text("DeviceModelName", gev::model_name, 32, o.model),
      text("DeviceVersion", gev::device_version, 32, o.firmware), text("DeviceID", gev::serial_number, 16, o.serial)};
}

/// Features of the transport layer of every model. The rest is in the registers of the standard.
Features transport_control() {
  return {{.name = "GevSCPSBigEndian",
           .kind = Kind::bit,
           .address = gev::stream_packet_size,
           .bit = 2,
           .about = "Byte order of pixels of more than eight bits."},
          {.name = "GevSCPD", .address = gev::stream_packet_delay, .about = "Pause between packets in ns."},
          {.name = "GevHeartbeatTimeout", .address = gev::heartbeat_timeout, .initial = 3000}};
}

Features chunk_control(std::uint32_t mode) {
  return {{.name = "ChunkModeActive",
           .kind = Kind::enumeration,
           .address = mode,
           .entries = {{"Off", 0}, {"On", 1}},
           .locked_while_streaming = true,
           .about = "Appends data of the exposure to every frame."},
          {.name = "ChunkExposureIndex",
           .kind = Kind::chunk_integer,
           .access = read_only,
           .bytes = 8,
           .chunk_id = chunk_exposure},
          {.name = "ChunkSensorTemperature",
           .kind = Kind::chunk_scaled,
           .access = read_only,
           .per_raw = 0.1,
           .chunk_id = chunk_sensor_temperature},
          {.name = "ChunkNUCActive", .kind = Kind::chunk_integer, .access = read_only, .chunk_id = chunk_nuc_active}};
}

/// Geometry, format and acquisition, in the order of the Ax5.
Features image_control(const ThermalCameraOptions& o, const ModelRegisters& r,
                       const std::vector<PixelFormat>& formats) {
  const auto width = static_cast<std::uint32_t>(o.width), height = static_cast<std::uint32_t>(o.height);
  const auto payload =
      o.only_format ? bytes_of_pixels(*o.only_format, std::size_t{width} * height) : 2 * width * height;
  return {locked_while_streaming(state("Width", r.width, width)),
          state("Height", r.height, height),
          locked_while_streaming(pixel_format(r.pixel_format, o.only_format ? std::vector{*o.only_format} : formats)),
          state("PayloadSize", r.payload_size, static_cast<std::uint32_t>(payload)),
          choice("AcquisitionMode", r.payload_size + 4, 0, {{"Continuous", 0}, {"SingleFrame", 1}, {"MultiFrame", 2}}),
          command("AcquisitionStart", r.acquisition_start, 1),
          command("AcquisitionStop", r.acquisition_stop, 1)};
}

/// Object parameters of the Ax5: factors in steps of 1/8192, temperatures in hundredths above 273 K. Neutral values.
Features ax5_object_parameters() {
  const auto factor = [](const char* name, std::uint32_t address) {
    return CameraFeature{
        .name = name, .kind = Kind::scaled, .address = address, .initial = 8192, .per_raw = 0.000122070312};
  };
  const auto kelvin = [](const char* name, std::uint32_t address) {
    return CameraFeature{
        .name = name, .kind = Kind::scaled, .address = address, .initial = 2000, .per_raw = 0.01, .offset = 273};
  };
  return {factor("ObjectEmissivity", 0xEA1C),        kelvin("ReflectedTemperature", 0xEA20),
          factor("WindowTransmission", 0xEA24),      kelvin("WindowTemperature", 0xEA28),
          factor("AtmosphericTransmission", 0xEA2C), kelvin("AtmosphericTemperature", 0xEA30)};
}

/// Power-up state as shipped: automatic corrections, counts instead of temperatures, eight bits, sharpening.
Features ax5_thermal(const ThermalCameraOptions& o, const ModelRegisters& r) {
  std::vector<std::pair<std::string, std::uint32_t>> standards;
  for (const auto& s : video_standards) standards.emplace_back(s.name, s.value);
  return {
      state("CameraSN", 0xE834, 48000123),
      {.name = "SensorFrameRate",
       .kind = Kind::enumeration,
       .address = 0xE850,
       .access = read_only,
       .initial = 4,
       .entries = {{"Slow", 0}, {"Fast", 4}}},
      command("NUCAction", r.nuc_action, 0),
      choice("SensorGainMode", 0xE980, 2, {{"Automatic", 0}, {"LowGainMode", 1}, {"HighGainMode", 2}, {"Manual", 3}}),
      choice("NUCMode", r.nuc_mode, r.nuc_mode_automatic, {{"Manual", 0}, {"Automatic", 1}, {"External", 2}}),
      {.name = "NUCIntervalFrames", .address = 0xE988, .initial = 3600, .least = 0, .most = 36000},
      {.name = "NUCTempDelta", .kind = Kind::scaled, .address = 0xE98C, .initial = 10, .per_raw = 0.1},
      choice("SensorDDEMode", 0xE9B0, 2, {{"Off", 0}, {"Manual", 1}, {"Automatic", 2}}),
      {.name = "SensorDDEGain", .address = 0xE9B4, .initial = 17, .least = 0, .most = 255},
      {.name = "ShutterPosition",
       .kind = Kind::enumeration,
       .address = 0xE9C0,
       .access = read_only,
       .entries = {{"Open", 0}, {"Close", 1}}},
      command("NUCActionLong", r.nuc_action_long, 0),
      {.name = "R", .address = 0xE9D4, .initial = 366545, .least = 10000, .most = 1000000},
      {.name = "B", .kind = Kind::scaled, .address = 0xE9E8, .initial = 1428000, .per_raw = 0.001},
      {.name = "F", .kind = Kind::scaled, .address = 0xE9EC, .initial = 1000, .per_raw = 0.001},
      {.name = "O", .kind = Kind::scaled, .address = 0xE9F0, .initial = 342000, .per_raw = 0.001},
      choice("TemperatureLinearMode", r.temperature_linear_mode, 0, {{"Off", 0}, {"On", 1}}),
      choice("TemperatureLinearResolution", r.temperature_linear_resolution, 0, {{"Low", 0}, {"High", 1}}),
      locked_while_streaming(
          choice("DigitalOutput", 0xEA3C, 2, {{"bit8bit", 2}, {"bit14bit", 3}, {"Disabled", 5}, {"Enabled", 6}})),
      choice("IRTestPattern", r.test_pattern, 0, {{"Off", 0}, {"Ascending_Ramp", 1}}),
      locked_while_streaming(choice("CMOSBitDepth", 0xEA50, 1, {{"bit14bit", 0}, {"bit8bit", 1}})),
      choice("SensorVideoStandard", r.video_standard, nearest_video_standard(o.frame_rate_hz), std::move(standards)),
      choice("ImageAdjustMethod", r.image_adjust, 0, {{"PlateauHistogram", 0}, {"Linear", 1}, {"Manual", 2}}),
      temperature("SensorTemperature", r.sensor_temperature, 0.1, 312),
      temperature("HousingTemperature", 0xEA94, 0.01, 2950),
      temperature("DeviceTemperature", 0xEA98, 0.1, 305)};
}

/// Completes a model from its own part.
ModelDescription composed(const ThermalCameraOptions& o, const ModelRegisters& r, const char* file_name,
                          const std::vector<PixelFormat>& formats, Features thermal) {
  Features image = image_control(o, r, formats);
  if (r.largest_count != 0) image.push_back(largest_count(r.largest_count, o.significant_bits));
  return {.genicam = {.vendor = o.vendor,
                      .model = o.model,
                      .file_name = file_name,
                      .categories = {{"DeviceControl", device_control(o)},
                                     {"ImageFormatControl", std::move(image)},
                                     {"ThermalControl", std::move(thermal)},
                                     {"ChunkDataControl", chunk_control(r.chunk_mode)},
                                     {"TransportLayerControl", transport_control()}}},
          .registers = r};
}

ModelDescription ax5(ThermalCameraOptions o) {
  if (o.vendor.empty()) o.vendor = "FLIR";
  if (o.model.empty()) o.model = "AX5";
  ModelRegisters r;
  r.width = 0xD300;
  r.height = 0xD304;
  r.pixel_format = 0xD308;
  r.payload_size = 0xD30C;
  r.acquisition_start = 0xD314;
  r.acquisition_stop = 0xD318;
  r.nuc_action = 0xE97C;
  r.nuc_mode = 0xE984;
  r.nuc_mode_automatic = 1;
  r.nuc_action_long = 0xE9CC;
  r.temperature_linear_mode = 0xEA08;
  r.temperature_linear_resolution = 0xEA0C;
  r.test_pattern = 0xEA40;
  r.image_adjust = 0xEA60;
  r.video_standard = 0xEA5C;
  r.sensor_temperature = 0xEA90;
  r.chunk_mode = 0xD400;
  auto camera = composed(o, r, "todbench_ax5.xml", {PixelFormat::mono8, PixelFormat::mono14, PixelFormat::mono16},
                         ax5_thermal(o, r));
  more_of(camera.genicam, "ObjectParameters") = ax5_object_parameters();
  return camera;
}

/// Registers of the models without published ones: arbitrary addresses.
ModelRegisters own_registers() {
  ModelRegisters r;
  r.width = 0xB000;
  r.height = 0xB004;
  r.pixel_format = 0xB008;
  r.payload_size = 0xB00C;
  r.acquisition_start = 0xB014;
  r.acquisition_stop = 0xB018;
  r.chunk_mode = 0xB020;
  r.largest_count = 0xB024;
  r.nuc_mode = 0xB100;
  r.nuc_action = 0xB104;
  r.sensor_temperature = 0xB10C;
  return r;
}

CameraFeature frame_rate(const ThermalCameraOptions& o) {
  return {.name = "AcquisitionFrameRate",
          .kind = Kind::scaled,
          .address = 0xB01C,
          .access = read_only,
          .initial = static_cast<std::uint32_t>(std::lround(1000 * o.frame_rate_hz)),
          .per_raw = 0.001};
}

ModelDescription a_series(ThermalCameraOptions o, CameraModel which) {
  const bool legacy = which == CameraModel::legacy_science;
  if (o.vendor.empty()) o.vendor = legacy ? "FLIR Systems AB" : "FLIR";
  if (o.model.empty()) o.model = legacy ? "A320G" : "A70";
  ModelRegisters r = own_registers();
  r.ir_format = 0xB108;
  r.noise_reduction = 0xB110;
  r.nuc_mode_automatic = 1;
  Features thermal{choice("IRFormat", r.ir_format, 0,
                          {{"Radiometric", 0}, {"TemperatureLinear100mK", 1}, {"TemperatureLinear10mK", 2}}),
                   choice("NUCMode", r.nuc_mode, 1, {{"Off", 0}, {"Automatic", 1}}),
                   command("NUCAction", r.nuc_action, 1),
                   choice("NoiseReduction", r.noise_reduction, 1, {{"Off", 0}, {"On", 1}}),
                   state("NumCases", 0xB114, 2),
                   {.name = "CurrentCase", .address = 0xB118, .least = 0, .most = 1},
                   temperature("SensorTemperature", r.sensor_temperature, 0.1, 312),
                   frame_rate(o)};
  auto out = composed(o, r, "todbench_a_series.xml", {PixelFormat::mono16}, std::move(thermal));
  if (legacy) {
    // The byte order cannot be read or changed.
    std::erase_if(more_of(out.genicam, "TransportLayerControl"),
                  [](const CameraFeature& f) { return f.name == "GevSCPSBigEndian"; });
  }
  return out;
}

ModelDescription unlisted(ThermalCameraOptions o) {
  if (o.vendor.empty()) o.vendor = "Example Infrared";
  if (o.model.empty()) o.model = "EX-1";
  ModelRegisters r = own_registers();
  Features thermal{choice("FlagMode", r.nuc_mode, 1, {{"Manual", 0}, {"Auto", 1}}),
                   command("FlagCalibrate", r.nuc_action, 1),
                   temperature("SensorTemperature", r.sensor_temperature, 0.1, 312), frame_rate(o)};
  r.nuc_mode_automatic = 1;
  return composed(o, r, "todbench_unlisted.xml", {PixelFormat::mono16}, std::move(thermal));
}

struct ModelName {
  CameraModel model;
  std::string_view name;
};
constexpr std::array<ModelName, 4> model_names{{{CameraModel::ax5, "ax5"},
                                                {CameraModel::a_series, "a-series"},
                                                {CameraModel::legacy_science, "legacy-science"},
                                                {CameraModel::unlisted, "unlisted"}}};

}  // namespace

std::string_view to_string(CameraModel model) {
  for (const auto& entry : model_names) {
    if (entry.model == model) return entry.name;
  }
  return "unknown";
}

std::optional<CameraModel> camera_model(std::string_view name) {
  for (const auto& entry : model_names) {
    if (entry.name == name) return entry.model;
  }
  return std::nullopt;
}

ModelDescription describe_camera(CameraModel model, const ThermalCameraOptions& options) {
  switch (model) {
    case CameraModel::ax5:
      return ax5(options);
    case CameraModel::a_series:
    case CameraModel::legacy_science:
      return a_series(options, model);
    case CameraModel::unlisted:
      return unlisted(options);
  }
  return ax5(options);
}

double video_standard_hz(std::uint32_t value) {
  for (const auto& standard : video_standards) {
    if (standard.value == value) return standard.rate_hz;
  }
  return 0;
}

}  // namespace todbench
