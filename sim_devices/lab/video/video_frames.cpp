// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/video/video_frames.h"

#include <algorithm>
#include <cmath>

#include "acquisition/v4l2/lepton_telemetry.h"

namespace todbench {
namespace {

void put_word(std::vector<std::uint8_t>& bytes, unsigned value) {
  bytes.push_back(static_cast<std::uint8_t>(value & 0xFFU));
  bytes.push_back(static_cast<std::uint8_t>(value >> 8U & 0xFFU));
}

PixelFormat format_of_counts(VideoCameraKind kind) {
  switch (kind) {
    case VideoCameraKind::y14:
      return PixelFormat::mono14;
    case VideoCameraKind::grey:
      return PixelFormat::mono8;
    default:
      return PixelFormat::mono16;
  }
}

/// Counts above the range are clipped.
void append(std::vector<std::uint8_t>& bytes, const cv::Mat1w& counts, PixelFormat format) {
  const cv::Mat1w cut = cv::min(counts, (1 << significant_bits(format)) - 1);
  const auto encoded = encode_pixels(cut, {.format = format, .width = counts.cols, .height = counts.rows});
  CV_Assert(encoded.has_value());
  bytes.insert(bytes.end(), encoded->begin(), encoded->end());
}

/// Upper half of a Tiny1 frame: the picture for people, stretched between its extremes.
cv::Mat1w picture_for_people(const cv::Mat1w& counts) {
  const auto [low, high] = std::minmax_element(counts.begin(), counts.end());
  const unsigned span = std::max(1U, static_cast<unsigned>(*high) - *low);
  cv::Mat1w picture = counts.clone();
  for (auto& count : picture) count = static_cast<std::uint16_t>((count - *low) * 255U / span);
  return picture;
}

LeptonTelemetry telemetry_of(const VideoCameraConfig& config, const VideoCameraState& state) {
  const auto time_ms = [&](std::uint64_t exposure) {
    return static_cast<std::uint32_t>(std::llround(static_cast<double>(exposure) * 1e3 / config.frame_rate_hz));
  };
  LeptonTelemetry telemetry;
  telemetry.revision = 0x0E0D;
  telemetry.time_ms = time_ms(state.exposure + 1);
  const unsigned ffc = state.correcting ? 2 : state.last_correction > 0 ? 3 : 0;
  telemetry.status = ffc << 4U;
  telemetry.frame_counter = static_cast<std::uint32_t>(state.exposure + 1);
  telemetry.fpa_temperature_k = 303.15;
  telemetry.fpa_temperature_ffc_k = 303.15;
  telemetry.time_last_ffc_ms = state.last_correction > 0 ? time_ms(state.last_correction + 1) : 0;
  telemetry.kelvin_per_count = kelvin_per_count(VideoCameraKind::lepton);
  return telemetry;
}

}  // namespace

Result<void> validate(const VideoCameraConfig& config) {
  const auto printable = [](const std::string& text, std::size_t most) {
    return !text.empty() && text.size() <= most &&
           std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
  };
  if (!printable(config.vendor, 60) || !printable(config.model, 60) || !printable(config.serial, 60)) {
    return fail(ErrorCode::invalid_input, "emulated video camera: names need 1 to 60 printable characters");
  }
  if (config.width < 8 || config.height < 8 || config.width > 4096 || config.height > 4096 || config.width % 2 != 0 ||
      config.height % 2 != 0) {
    return fail(ErrorCode::invalid_input, "emulated video camera: width and height must be even, 8 ... 4096");
  }
  if (config.kind == VideoCameraKind::temperature_rows && 2 * config.height <= config.width) {
    return fail(ErrorCode::invalid_input,
                "emulated video camera: with temperature rows, twice the height must exceed the width");
  }
  if (!(config.frame_rate_hz >= 0.1 && config.frame_rate_hz <= 1000)) {
    return fail(ErrorCode::invalid_input, "emulated video camera: the frame rate must be 0.1 ... 1000 Hz");
  }
  if (config.nuc_freeze_frames < 0) {
    return fail(ErrorCode::invalid_input, "emulated video camera: nuc_freeze_frames must not be negative");
  }
  return {};
}

bool arrives_short(const VideoCameraConfig& config, std::uint64_t exposure) {
  return config.short_frame_interval > 0 &&
         (exposure + 1) % static_cast<std::uint64_t>(config.short_frame_interval) == 0;
}

double kelvin_per_count(VideoCameraKind kind) {
  switch (kind) {
    case VideoCameraKind::lepton:
      return 0.01;
    case VideoCameraKind::temperature_rows:
      return 1.0 / 64;
    default:
      return 0;
  }
}

int significant_bits(VideoCameraKind kind) {
  return significant_bits(format_of_counts(kind));
}

UsbIdentity usb_identity(VideoCameraKind kind) {
  switch (kind) {
    case VideoCameraKind::lepton:
      return {0x1e4e, 0x0100};
    case VideoCameraKind::temperature_rows:
      return {0x0bda, 0x5830};
    case VideoCameraKind::boson:
      return {0x09cb, 0x4007};
    default:
      return {0x1209, 0x0001};
  }
}

VideoWireFormat wire_format(const VideoCameraConfig& config) {
  const cv::Size size(config.width, config.height);
  switch (config.kind) {
    case VideoCameraKind::lepton:
      return {PixelFormat::mono16, {size, {config.width, config.height + lepton_telemetry_rows(config.width)}}};
    case VideoCameraKind::boson:
      return {PixelFormat::mono16, {{config.width, config.height + 2}, size}};
    case VideoCameraKind::temperature_rows:
      return {PixelFormat::yuyv, {size, {config.width, 2 * config.height}}};
    default:
      return {format_of_counts(config.kind), {size}};
  }
}

std::vector<std::uint8_t> wire_frame(const VideoCameraConfig& config, const cv::Mat1w& counts, cv::Size size,
                                     const VideoCameraState& state) {
  CV_Assert(counts.cols == config.width && counts.rows == config.height);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(2 * static_cast<std::size_t>(size.area()));
  if (state.exposure < static_cast<std::uint64_t>(std::max(0, config.empty_first_frames))) {
    bytes.resize(static_cast<std::size_t>(size.area()) *
                 static_cast<std::size_t>(wire_format(config).bytes_per_pixel()));
    return bytes;
  }
  if (config.kind == VideoCameraKind::temperature_rows) {
    append(bytes, picture_for_people(counts), PixelFormat::yuyv);
    if (size.height == config.height) return bytes;  // only the picture
  }
  append(bytes, counts, format_of_counts(config.kind));
  if (config.kind == VideoCameraKind::boson && size.height > config.height) {
    put_word(bytes, static_cast<unsigned>(state.exposure));
    bytes.resize(2 * static_cast<std::size_t>(size.area()), 0);
  }
  if (config.kind == VideoCameraKind::lepton && size.height > config.height) {
    for (const auto word : encode_lepton_telemetry(telemetry_of(config, state))) put_word(bytes, word);
    bytes.resize(2 * static_cast<std::size_t>(size.area()), 0);
  }
  return bytes;
}

}  // namespace todbench
