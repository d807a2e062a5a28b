// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/aravis/camera_setup.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>

#include "acquisition/aravis/genicam_features.h"
#include "acquisition/aravis/object_parameters.h"
#include "acquisition/aravis/u3v_registers.h"
#include "acquisition/base/try.h"

namespace todbench {
namespace {

/// Formats that a camera is set to; of those with equally many bits the first: unpacked ones come before packed ones.
/// Mono14 precedes Mono16 so that it is preferred if both
/// carry 14 bits: only its name states the full scale.
constexpr std::array usable_formats{PixelFormat::mono14,  PixelFormat::mono16,       PixelFormat::mono12,
                                    PixelFormat::mono10,  PixelFormat::mono12p,      PixelFormat::mono12_packed,
                                    PixelFormat::mono10p, PixelFormat::mono10_packed};

/// Exceeds every thermal camera's picture; the limit bounds the memory that a camera's statement can reserve.
constexpr int most_pixels_per_side = 16384;

constexpr const char* chunk_mode = "ChunkModeActive";

constexpr std::array recorded_features{
    "PixelFormat",
    "Width",
    "Height",
    "OffsetX",
    "OffsetY",
    "BinningHorizontal",
    "BinningVertical",
    "PixelDynamicRangeMax",
    "IRFormat",
    "TemperatureLinearMode",
    "TemperatureLinearResolution",
    "TemperatureLinearScale",
    "TemperatureLinearOffset",
    "CMOSBitDepth",
    "DigitalOutput",
    "SensorGainMode",
    "CurrentCase",
    "NUCMode",
    "NUCIntervalFrames",
    "NUCTempDelta",
    "NoiseReduction",
    "SensorDDEMode",
    "ImageCompressionMode",
    "ImageAdjustMethod",
    "ExposureTime",
    "ExposureTimeAbs",
    "Gain",
    "GainRaw",
    "AcquisitionFrameRate",
    "SensorVideoStandard",
    "IRFrameRate",
    "DeviceTemperature",
    "SensorTemperature",
    "HousingTemperature",
    "R",
    "B",
    "F",
    "O",
    "J0",
    "J1",
    "DeviceFirmwareVersion",
    "DeviceVersion",
    "DeviceUserID",
    "GevSCPSPacketSize",
    "GevSCPD",
    "GevSCPSBigEndian",
};

/// Significant bits of a Mono16 pixel: from the converter or the largest count that the camera states, otherwise 16.
int bits_in_mono16(ArvDevice* device) {
  for (const char* feature : {"CMOSBitDepth", "DigitalOutput"}) {
    const auto value = get_feature(device, feature);
    if (value && value->find("14") != std::string::npos) return 14;
  }
  const auto largest = get_number(device, "PixelDynamicRangeMax");
  if (largest && *largest >= 255 && *largest <= 65535) return std::bit_width(static_cast<unsigned>(*largest));
  return 16;
}

int significant_bits(ArvDevice* device, PixelFormat format) {
  return format == PixelFormat::mono16 ? bits_in_mono16(device) : significant_bits(format);
}

Result<void> choose_pixel_format(ArvDevice* device, const std::string& wanted) {
  const auto offered = enumeration_entries(device, "PixelFormat");
  std::optional<PixelFormat> best;
  std::string names;
  for (const auto& name : offered) names += (names.empty() ? "" : ", ") + name;
  for (const auto format : usable_formats) {
    if (std::find(offered.begin(), offered.end(), to_string(format)) == offered.end()) continue;
    if (!wanted.empty() && wanted != to_string(format)) continue;
    if (!best || significant_bits(device, format) > significant_bits(device, *best)) best = format;
  }
  if (!best) {
    return fail(ErrorCode::not_found,
                (wanted.empty() ? "no 10 ... 16 bit monochrome pixel format" : "no usable pixel format " + wanted) +
                    "; the camera offers " + (names.empty() ? "none" : names));
  }
  auto chosen = set_feature(device, "PixelFormat", std::string(to_string(*best)));
  if (!chosen && chosen.error().code != ErrorCode::disconnected) chosen.error().code = ErrorCode::not_found;
  return chosen;
}

/// Sets the best offered entry of one preference. Returns a warning if the camera refuses all entries.
Result<std::optional<std::string>> apply(ArvDevice* device, const FeatureChoice& preference) {
  const std::string& feature = preference.feature;
  if (!has_feature(device, feature)) return std::nullopt;
  std::optional<std::string> warning;
  for (const auto& entry : preference.entries) {
    const auto entries = enumeration_entries(device, feature);
    if (!entries.empty() && std::find(entries.begin(), entries.end(), entry) == entries.end()) continue;
    const auto done = set_feature(device, feature, entry);
    if (done) return std::nullopt;
    if (done.error().code == ErrorCode::disconnected) return tl::unexpected(done.error());
    warning = "The camera keeps its own setting: " + done.error().message + ".";
  }
  return warning;
}

std::optional<double> number(ArvDevice* device, const char* feature) {
  if (!has_feature(device, feature)) return std::nullopt;
  const auto value = get_number(device, feature);
  return value ? std::optional(*value) : std::nullopt;
}

/// The family's linear mode that corresponds to the camera's present settings.
const LinearMode* present_linear_scale(ArvDevice* device, const CameraFamily& family) {
  for (const auto& line : family.linear) {
    if (has_feature(device, line.mode) && get_feature(device, line.mode).value_or("") == line.mode_entry &&
        get_feature(device, line.step).value_or("") == line.step_entry) {
      return &line;
    }
  }
  return nullptr;
}

/// Whether counts are proportional to temperature at present, with any step.
bool temperature_linear(ArvDevice* device, const CameraFamily& family) {
  return std::any_of(family.linear.begin(), family.linear.end(), [&](const LinearMode& line) {
    return has_feature(device, line.mode) && get_feature(device, line.mode).value_or("") == line.mode_entry;
  });
}

std::optional<double> linear_step(ArvDevice* device, const CameraFamily& family) {
  if (const auto step = number(device, "TemperatureLinearScale"); step && *step > 0) return step;
  const LinearMode* line = present_linear_scale(device, family);
  return line != nullptr ? std::optional(line->kelvin_per_count) : std::nullopt;
}

}  // namespace

Result<std::vector<std::string>> prepare_camera(ArvCamera* camera, const CameraFamily& family,
                                                const std::string& wanted) {
  ArvDevice* device = arv_camera_get_device(camera);
  std::vector<std::string> warnings;
  for (const auto& preference : family.choices) {
    TODBENCH_TRY(auto warning, apply(device, preference));
    if (warning) warnings.push_back(*warning);
  }
  // Chunks contain nothing that is measured, and those of GigE Vision 1.x come without the size of the picture.
  const std::string chunks = has_feature(device, chunk_mode) ? get_feature(device, chunk_mode).value_or("") : "";
  if (chunks == "true" || chunks == "On") {
    if (const auto off = set_feature(device, chunk_mode, chunks == "On" ? "Off" : "false"); !off) {
      if (off.error().code == ErrorCode::disconnected) return tl::unexpected(off.error());
      warnings.push_back("The camera still appends chunk data to its frames: " + off.error().message + ".");
    }
  }
  TODBENCH_TRY_VOID(choose_pixel_format(device, wanted));
  return warnings;
}

Result<StreamFormat> read_stream_format(ArvCamera* camera) {
  ArvDevice* device = arv_camera_get_device(camera);
  GErrorSlot error;
  StreamFormat format;
  if (arv_camera_is_uv_device(camera) != 0) format.transport = AravisTransport::usb3_vision;
  gint x = 0;
  gint y = 0;
  arv_camera_get_region(camera, &x, &y, &format.width, &format.height, error.out());
  if (error) return error.failure(ErrorCode::not_found, "reading the image geometry");
  const auto known = pixel_format_of_pfnc(arv_camera_get_pixel_format(camera, error.out()));
  if (error) return error.failure(ErrorCode::not_found, "reading the pixel format");
  // Eight bits are accepted if the user set them; the set-up never selects them.
  if (!known || (*known != PixelFormat::mono8 &&
                 std::find(usable_formats.begin(), usable_formats.end(), *known) == usable_formats.end())) {
    return fail(ErrorCode::not_found, "pixel format " + get_feature(device, "PixelFormat").value_or("") +
                                          " is not an 8 ... 16 bit monochrome format that this program reads");
  }
  format.pixel_format = *known;
  format.significant_bits = significant_bits(device, *known);
  format.payload_bytes = arv_camera_get_payload(camera, error.out());
  if (error) return error.failure(ErrorCode::not_found, "reading the payload size");
  if (format.width > most_pixels_per_side || format.height > most_pixels_per_side ||
      format.payload_bytes > most_payload_bytes) {
    return fail(ErrorCode::not_found, "the camera states a picture size of " + std::to_string(format.width) + " x " +
                                          std::to_string(format.height) + " pixels in " +
                                          std::to_string(format.payload_bytes) +
                                          " bytes, which is larger than the program accepts");
  }
  const auto pixels = static_cast<std::size_t>(format.width) * static_cast<std::size_t>(format.height);
  if (format.width <= 0 || format.height <= 0 || format.payload_bytes < bytes_of_pixels(*known, pixels)) {
    return fail(ErrorCode::not_found, "the camera states an impossible geometry of " + std::to_string(format.width) +
                                          " x " + std::to_string(format.height) + " pixels in " +
                                          std::to_string(format.payload_bytes) + " bytes");
  }
  format.big_endian =
      has_feature(device, "GevSCPSBigEndian") && get_feature(device, "GevSCPSBigEndian").value_or("false") == "true";
  return format;
}

RadiometricScale read_scale(ArvDevice* device, const CameraFamily& family) {
  if (temperature_linear(device, family)) {
    const auto step = linear_step(device, family);
    if (!step) return {};
    const double offset_k = number(device, "TemperatureLinearOffset").value_or(0);
    return RadiometricScale::linear({*step, offset_k}).value_or(RadiometricScale());
  }
  const auto r = number(device, "R");
  const auto b = number(device, "B");
  const auto f = number(device, "F");
  if (!r || !b || !f) return {};
  if (const auto j0 = number(device, "J0"), j1 = number(device, "J1"); j0 && j1) {
    return RadiometricScale::planck({*r * *j1, *b, *f, *j0}).value_or(RadiometricScale());
  }
  if (const auto o = number(device, "O")) {
    return RadiometricScale::planck({*r, *b, *f, *o}).value_or(RadiometricScale());
  }
  return {};
}

double read_frame_rate(ArvCamera* camera, const CameraFamily& family) {
  ArvDevice* device = arv_camera_get_device(camera);
  for (const auto& feature : family.frame_rate) {
    if (const auto rate = number(device, feature.c_str()); rate && std::isfinite(*rate) && *rate > 0) return *rate;
    // "PAL50HZ", "NTSC60HZ", "Rate50Hz": the digits are the rate.
    const auto entry = get_feature(device, feature);
    if (!entry) continue;
    const auto digit = std::find_if(entry->begin(), entry->end(), [](unsigned char c) { return std::isdigit(c); });
    double rate = 0;
    if (digit != entry->end()) std::from_chars(&*digit, entry->data() + entry->size(), rate);
    if (std::isfinite(rate) && rate > 0) return rate;
  }
  return 0;
}

Result<std::map<std::string, std::string>> read_settings(ArvDevice* device) {
  std::map<std::string, std::string> settings;
  std::optional<Error> lost;
  const auto read = [&](const char* feature) {
    if (lost) return;
    auto value = get_feature(device, feature);
    if (value) {
      settings[feature] = *std::move(value);
    } else if (value.error().code == ErrorCode::disconnected) {
      lost = std::move(value.error());
    }
  };
  for (const char* feature : recorded_features) read(feature);
  for (const char* feature : object_parameters()) read(feature);
  if (lost) return tl::unexpected(*std::move(lost));
  return settings;
}

std::vector<std::string> nonuniformity_commands(ArvDevice* device, const CameraFamily& family) {
  std::vector<std::string> commands;
  for (const auto& known : family.nuc_commands) {
    if (ARV_IS_GC_COMMAND(arv_device_get_feature(device, known.c_str()))) commands.push_back(known);
  }
  return commands.empty() ? correction_commands(command_names(device)) : commands;
}

Result<std::optional<std::string>> take_over_corrections(ArvDevice* device, const CameraFamily& family) {
  std::vector<std::string> modes;
  if (has_feature(device, family.nuc_mode)) {
    modes.push_back(family.nuc_mode);
  } else {
    modes = correction_modes(enumeration_names(device));
  }
  if (modes.empty()) return std::nullopt;
  const auto entries = enumeration_entries(device, modes.front());
  std::string entry;
  for (const auto& known : family.nuc_commanded) {
    if (entry.empty() && std::find(entries.begin(), entries.end(), known) != entries.end()) entry = known;
  }
  if (entry.empty()) entry = commanded_entry(entries);
  if (entry.empty()) return "The automatic non-uniformity correction of the camera cannot be switched off.";
  if (get_feature(device, modes.front()).value_or("") == entry) return std::nullopt;
  const auto done = set_feature(device, modes.front(), entry);
  if (done) return std::nullopt;
  if (done.error().code == ErrorCode::disconnected) return tl::unexpected(done.error());
  return "The automatic non-uniformity correction of the camera stays on: " + done.error().message + ".";
}

CameraFamily family_of(ArvDevice* device, const SourceInfo& info) {
  return camera_family(info.vendor, info.model,
                       [device](const std::string& feature) { return has_feature(device, feature); });
}

}  // namespace todbench
