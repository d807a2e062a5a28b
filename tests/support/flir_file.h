// SPDX-License-Identifier: GPL-3.0-or-later
// A small writer of FLIR's containers, by the tag tables of the ExifTool project.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace todbench::testing {

/// Constants of a made camera.
struct FlirFileCamera {
  float r1 = 21106.77F, r2 = 0.012545258F, b = 1501, f = 1;
  std::int32_t o = -7340;
  float emissivity = 1, distance_m = 0;
  std::uint16_t frame_rate_hz = 30, raw_median = 0;
  std::string model = "FLIR SC660", serial = "404003980", lens = "FOL38";
};

inline void put(std::string& bytes, std::size_t at, std::uint64_t value, std::size_t length) {
  for (std::size_t i = 0; i < length; ++i) bytes[at + i] = static_cast<char>(value >> 8 * i & 255);
}
inline void put_float(std::string& bytes, std::size_t at, float value) {
  put(bytes, at, std::bit_cast<std::uint32_t>(value), 4);
}
inline void put_text(std::string& bytes, std::size_t at, const std::string& text) {
  bytes.replace(at, text.size(), text);
}

/// The block of constants, little-endian; `time_ms` since 1970.
inline std::string flir_camera_info(const FlirFileCamera& camera, std::uint64_t time_ms) {
  std::string block(0x470, '\0');
  put(block, 0, 2, 2);
  put_float(block, 0x20, camera.emissivity);
  put_float(block, 0x24, camera.distance_m);
  for (const std::size_t at : {0x28, 0x2C, 0x30}) put_float(block, at, 293.15F);
  put_float(block, 0x34, 1);
  put_float(block, 0x3C, 0.5F);
  put_float(block, 0x58, camera.r1);
  put_float(block, 0x5C, camera.b);
  put_float(block, 0x60, camera.f);
  put_float(block, 0x90, 393.15F);
  put_float(block, 0x94, 233.15F);
  put_text(block, 0xD4, camera.model);
  put_text(block, 0x104, camera.serial);
  put_text(block, 0x170, camera.lens);
  put(block, 0x308, static_cast<std::uint32_t>(camera.o), 4);
  put_float(block, 0x30C, camera.r2);
  put(block, 0x338, camera.raw_median, 2);
  put(block, 0x384, time_ms / 1000, 4);
  put(block, 0x388, time_ms % 1000, 2);
  put(block, 0x464, camera.frame_rate_hz, 2);
  return block;
}

/// The block of pixels, stored as given.
inline std::string flir_raw_data(int width, int height, const std::string& pixels) {
  std::string block(32, '\0');
  put(block, 0, 2, 2);
  put(block, 2, static_cast<std::uint64_t>(width), 2);
  put(block, 4, static_cast<std::uint64_t>(height), 2);
  return block + pixels;
}

/// One record of these two blocks; an empty one is left out.
inline std::string flir_record(const std::string& camera_info, const std::string& raw_data) {
  constexpr std::size_t header = 64, entry = 32;
  std::string record(header + 2 * entry, '\0');
  put_text(record, 0, "FFF");
  put(record, 20, 101, 4);
  put(record, 24, header, 4);
  put(record, 28, 2, 4);
  std::size_t at = header;
  for (const auto& [type, block] : {std::pair{0x20U, camera_info}, std::pair{0x01U, raw_data}}) {
    put(record, at, block.empty() ? 0 : type, 2);
    put(record, at + 12, record.size(), 4);
    put(record, at + 16, block.size(), 4);
    record += block;
    at += entry;
  }
  return record;
}

/// Counts as raw pixels, little-endian.
inline std::string raw_pixels(const cv::Mat1w& counts) {
  std::string bytes;
  for (const auto count : counts) bytes += {static_cast<char>(count & 255), static_cast<char>(count >> 8)};
  return bytes;
}

/// A JPEG without a picture, with the record in segments of `segment_bytes`.
inline std::vector<std::string> flir_segments(const std::string& record, std::size_t segment_bytes) {
  std::vector<std::string> segments;
  const std::size_t last = (record.size() - 1) / segment_bytes;
  for (std::size_t k = 0; k <= last; ++k) {
    const std::string part = record.substr(k * segment_bytes, segment_bytes);
    const std::size_t length = part.size() + 10;
    segments.push_back({'\xff', '\xe1', static_cast<char>(length >> 8), static_cast<char>(length & 255), 'F', 'L', 'I',
                        'R', '\0', '\1', static_cast<char>(k), static_cast<char>(last)});
    segments.back() += part;
  }
  return segments;
}
inline std::string jpeg_with(const std::vector<std::string>& segments) {
  std::string jpeg("\xff\xd8\xff\xe0\x00\x10JFIF\0\1\1\0\0\1\0\1\0\0", 20);
  for (const auto& segment : segments) jpeg += segment;
  return jpeg + std::string("\xff\xda\x00\x02\xff\xd9", 6);
}

}  // namespace todbench::testing
