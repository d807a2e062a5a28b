// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/genicam/thermal_features.h"

#include <algorithm>
#include <cassert>

namespace todbench {

namespace features {

using Kind = FeatureKind;
constexpr auto read_only = FeatureAccess::read_only;

CameraFeature text(const char* name, std::uint32_t address, std::uint32_t bytes, std::string content) {
  return {.name = name,
          .kind = Kind::text,
          .address = address,
          .access = read_only,
          .bytes = bytes,
          .text = std::move(content)};
}

CameraFeature choice(const char* name, std::uint32_t address, std::uint32_t initial, Entries entries) {
  return {
      .name = name, .kind = Kind::enumeration, .address = address, .initial = initial, .entries = std::move(entries)};
}

CameraFeature command(const char* name, std::uint32_t address, std::uint32_t value) {
  return {
      .name = name, .kind = Kind::command, .address = address, .access = FeatureAccess::write_only, .initial = value};
}

CameraFeature state(const char* name, std::uint32_t address, std::uint32_t initial) {
  return {.name = name, .address = address, .access = read_only, .initial = initial};
}

CameraFeature temperature(const char* name, std::uint32_t address, double per_raw, std::uint32_t raw) {
  return {
      .name = name, .kind = Kind::scaled, .address = address, .access = read_only, .initial = raw, .per_raw = per_raw};
}

CameraFeature real(const char* name, std::uint32_t address, double value) {
  return {.name = name, .kind = Kind::ieee_float, .address = address, .access = read_only, .real = value};
}

CameraFeature pixel_format(std::uint32_t address, const std::vector<PixelFormat>& formats) {
  Entries entries;
  for (const auto format : formats) entries.emplace_back(to_string(format), pfnc_code(format));
  return choice("PixelFormat", address, pfnc_code(formats.front()), std::move(entries));
}

CameraFeature largest_count(std::uint32_t address, int significant_bits) {
  return state("PixelDynamicRangeMax", address, (1U << static_cast<unsigned>(significant_bits)) - 1);
}

CameraFeature locked_while_streaming(CameraFeature feature) {
  feature.locked_while_streaming = true;
  return feature;
}

}  // namespace features

std::vector<CameraFeature>& more_of(CameraDescription& camera, const std::string& category) {
  for (auto& [name, members] : camera.categories) {
    if (name == category) return members;
  }
  return camera.categories.emplace_back(category, std::vector<CameraFeature>()).second;
}

CameraFeature& feature_named(CameraDescription& camera, const std::string& name) {
  for (auto& [category, members] : camera.categories) {
    const auto found = std::find_if(members.begin(), members.end(), [&](const auto& f) { return f.name == name; });
    if (found != members.end()) return *found;
  }
  assert(false && "no such feature");
  return camera.categories.front().second.front();
}

CameraDescription thermal_camera(const ThermalRegisters& r, const ThermalCameraOptions& o) {
  using namespace features;
  const auto width = static_cast<std::uint32_t>(o.width), height = static_cast<std::uint32_t>(o.height);
  std::vector formats{PixelFormat::mono14, PixelFormat::mono16};
  if (o.significant_bits > 14) std::reverse(formats.begin(), formats.end());
  return {
      .vendor = o.vendor,
      .model = o.model,
      .file_name = {},
      .categories = {
          {"DeviceControl",
           {text("DeviceVendorName", r.vendor, r.name_bytes, o.vendor),
            text("DeviceModelName", r.model, r.name_bytes, o.model),
            text("DeviceFirmwareVersion", r.firmware, r.name_bytes, o.firmware),
            text("DeviceSerialNumber", r.serial, r.serial_bytes, o.serial)}},
          {"ImageFormatControl",
           {state("Width", r.width, width), state("Height", r.height, height), state("OffsetX", r.offset_x, 0),
            state("OffsetY", r.offset_y, 0), pixel_format(r.pixel_format, formats),
            largest_count(r.largest_count, o.significant_bits),
            state("PayloadSize", r.payload_size, 2 * width * height)}},
          {"AcquisitionControl",
           {choice("AcquisitionMode", r.acquisition_mode, acquisition_continuous,
                   {{"Continuous", acquisition_continuous}}),
            command("AcquisitionStart", r.acquisition, 1),
            command("AcquisitionStop", r.acquisition, 0),
            {.name = "AcquisitionFrameRate",
             .kind = FeatureKind::rate,
             .address = r.period_us,
             .initial = static_cast<std::uint32_t>(std::lround(1e6 / o.frame_rate_hz)),
             .about = "Exposures per second. Stored as a whole number of microseconds per exposure."}}},
          {"ThermalControl",
           {choice("IRFormat", r.ir_format, ir_format_10mk,
                   {{"TemperatureLinear100mK", ir_format_100mk}, {"TemperatureLinear10mK", ir_format_10mk}}),
            {.name = "TemperatureLinearScale",
             .kind = FeatureKind::formula,
             .address = r.linear_scale,
             .access = FeatureAccess::read_only,
             .real = o.kelvin_per_count,
             .about = "Kelvin per count. Its nominal values, 0.01 and 0.1, give the entries of IRFormat their names.",
             .formula = "(CHOICE = 1) ? (VALUE * 10) : VALUE",
             .choice = "IRFormat"},
            real("TemperatureLinearOffset", r.linear_offset, o.offset_k),
            choice("NUCMode", r.nuc_mode, nuc_mode_manual, {{"Manual", nuc_mode_manual}}),
            command("NUCAction", r.nuc_action, 1)}}}};
}

}  // namespace todbench
