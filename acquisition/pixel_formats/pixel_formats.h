// SPDX-License-Identifier: GPL-3.0-or-later
// Table of the known pixel formats, and conversion between the bytes that cameras send and 16-bit counts. Pure
// functions over untrusted bytes; sizes are checked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// Layout of a pixel's counts in bytes.
enum class PixelFormat {
  mono8,          ///< one byte
  mono10,         ///< two bytes, the low 10 bits
  mono12,         ///< two bytes, the low 12 bits
  mono14,         ///< two bytes, the low 14 bits
  mono16,         ///< two bytes
  yuyv,           ///< two bytes: the luma of the pixel, then a byte that is ignored
  mono10p,        ///< PFNC: consecutive groups of 10 bits, the lowest bit first
  mono12p,        ///< PFNC: consecutive groups of 12 bits, the lowest bit first
  mono10_packed,  ///< GigE Vision: two pixels in three bytes, the middle byte contains the low bits of both
  mono12_packed,  ///< GigE Vision: likewise with 12 bits
};

/// Names and codes of a format: the name of the GenICam Pixel Format Naming Convention (PFNC 2.4), the 32-bit code of
/// GigE Vision and USB3 Vision, the four-character code of V4L2.
struct PixelFormatFacts {
  PixelFormat format;
  std::string_view name;
  std::uint32_t pfnc;
  const char* fourcc;    ///< null: none
  int significant_bits;  ///< used bits of a pixel
  int bits_per_pixel;    ///< bits that a pixel occupies
};

/// The formats that the back ends read and that the emulated cameras send.
inline constexpr PixelFormatFacts pixel_format_table[] = {
    {PixelFormat::mono8, "Mono8", 0x01080001, "GREY", 8, 8},
    {PixelFormat::mono10, "Mono10", 0x01100003, "Y10 ", 10, 16},
    {PixelFormat::mono12, "Mono12", 0x01100005, "Y12 ", 12, 16},
    {PixelFormat::mono14, "Mono14", 0x01100025, "Y14 ", 14, 16},
    {PixelFormat::mono16, "Mono16", 0x01100007, "Y16 ", 16, 16},
    {PixelFormat::yuyv, "YUV422_8", 0x02100032, "YUYV", 8, 16},
    {PixelFormat::mono10p, "Mono10p", 0x010A0046, nullptr, 10, 10},
    {PixelFormat::mono12p, "Mono12p", 0x010C0047, nullptr, 12, 12},
    {PixelFormat::mono10_packed, "Mono10Packed", 0x010C0004, nullptr, 10, 12},
    {PixelFormat::mono12_packed, "Mono12Packed", 0x010C0006, nullptr, 12, 12}};

/// Returns the format's entry in the table.
[[nodiscard]] constexpr const PixelFormatFacts& facts_of(PixelFormat format) {
  for (const auto& facts : pixel_format_table) {
    if (facts.format == format) return facts;
  }
  return pixel_format_table[0];  // not reached: every format has a line
}

/// Returns the number of bytes of `pixels` consecutive pixels; the last byte of a packed format may be partly used.
[[nodiscard]] constexpr std::size_t bytes_of_pixels(PixelFormat format, std::size_t pixels) {
  return (pixels * static_cast<std::size_t>(facts_of(format).bits_per_pixel) + 7) / 8;
}

/// Byte order of pixels with two bytes of counts (mono10, 12, 14, 16); the other formats ignore it.
enum class ByteOrder { little_endian, big_endian };

/// Returns the PFNC name, e.g. "Mono14"; "YUV422_8" for yuyv.
[[nodiscard]] constexpr std::string_view to_string(PixelFormat format) {
  return facts_of(format).name;
}
/// Convert to and from the PFNC code. pixel_format_of_pfnc() returns empty for a code that is not in the table.
[[nodiscard]] constexpr std::uint32_t pfnc_code(PixelFormat format) {
  return facts_of(format).pfnc;
}
[[nodiscard]] std::optional<PixelFormat> pixel_format_of_pfnc(std::uint32_t code);
[[nodiscard]] constexpr int significant_bits(PixelFormat format) {
  return facts_of(format).significant_bits;
}

/// Meaning of a four-character code of V4L2.
struct FourccFormat {
  PixelFormat format;
  ByteOrder order;
  bool operator==(const FourccFormat&) const = default;
};
/// Returns the format of "Y16 ", "Y16 " with bit 31 set (big-endian, listed as "Y16 -BE"), "Y14 ", "Y12 ", "Y10 ",
/// "GREY", "YUYV"; empty for any other code. The code is v4l2_fourcc(): first character in the low byte.
[[nodiscard]] std::optional<FourccFormat> format_of_fourcc(std::uint32_t fourcc);
/// Returns the code of a format, little-endian if the format has a byte order; 0: none.
[[nodiscard]] std::uint32_t fourcc_code(PixelFormat format);

/// A picture in memory.
struct PixelLayout {
  PixelFormat format = PixelFormat::mono16;
  ByteOrder order = ByteOrder::little_endian;
  int width = 0, height = 0;  ///< pixels, 1 ... 65535
  /// Distance between the starts of two rows in bytes. 0: rows without gaps; neighbouring rows of a packed format then
  /// share a byte if they do not fill whole bytes.
  std::size_t row_bytes = 0;
};

/// Returns the number of bytes of a picture. Error: `invalid_input` (impossible geometry, rows shorter than their
/// pixels).
[[nodiscard]] Result<std::size_t> picture_bytes(const PixelLayout& layout);

/// Returns the counts of a picture unchanged: bits above significant_bits() in two-byte formats are kept for the
/// integrity gate. Excess bytes are ignored. Errors: `invalid_input` as picture_bytes(), or too few bytes.
[[nodiscard]] Result<cv::Mat1w> decode_pixels(std::span<const std::uint8_t> bytes, const PixelLayout& layout);

/// Encodes a picture for a device that sends it: the inverse of decode_pixels(). Padding and ignored bytes are zero
/// (for yuyv 128, no colour). Returns exactly picture_bytes(). Errors: `invalid_input` as picture_bytes(), a picture of
/// a wrong size, or a pixel that exceeds significant_bits().
[[nodiscard]] Result<std::vector<std::uint8_t>> encode_pixels(const cv::Mat1w& counts, const PixelLayout& layout);

/// Rows of a frame with a separate meaning: display picture, temperatures or telemetry.
struct RowSection {
  int first = 0, count = 0;
};

/// Returns the bytes of a section of a frame with two-byte pixels, for separate decoding. For example, cameras of the
/// InfiRay class send frames of 256 x 384 YUYV, in which rows 192 ... 383 contain 256 x 192 temperatures of 16 bits,
/// little-endian. Telemetry rows of a Lepton have 16 bits, like its picture. `row_bytes` as in PixelLayout, but not 0.
/// Error: `invalid_input` if the section exceeds the bytes.
[[nodiscard]] Result<std::span<const std::uint8_t>> section_bytes(std::span<const std::uint8_t> frame,
                                                                  std::size_t row_bytes, RowSection section);

}  // namespace todbench
