// The pixel formats that are known, in one table; bytes as cameras send them, to 16-bit counts and back. Pure
// functions; sizes are checked, nothing is assumed of the bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

/// How the counts of one pixel lie in the bytes.
enum class PixelFormat {
  mono8,   ///< one byte
  mono10,  ///< two bytes, the low 10 bits
  mono12,  ///< two bytes, the low 12 bits
  mono14,  ///< two bytes, the low 14 bits
  mono16,  ///< two bytes
  yuyv,    ///< two bytes, the first is the luma of the pixel and the second is dropped
};

/// What is known of a format, wherever it is met: the name of the GenICam Pixel Format Naming Convention (PFNC 2.4),
/// the 32-bit code that GigE Vision and USB3 Vision send for it, the four-character code of V4L2.
struct PixelFormatFacts {
  PixelFormat format;
  std::string_view name;
  std::uint32_t pfnc;
  const char* fourcc;
  int significant_bits;  ///< bits of a pixel that can be set
  int bytes_per_pixel;
};

/// The formats that the back ends read and the emulated cameras send. Packed ones (Mono12p, Mono12Packed) are not among
/// them.
inline constexpr PixelFormatFacts pixel_format_table[] = {{PixelFormat::mono8, "Mono8", 0x01080001, "GREY", 8, 1},
                                                          {PixelFormat::mono10, "Mono10", 0x01100003, "Y10 ", 10, 2},
                                                          {PixelFormat::mono12, "Mono12", 0x01100005, "Y12 ", 12, 2},
                                                          {PixelFormat::mono14, "Mono14", 0x01100025, "Y14 ", 14, 2},
                                                          {PixelFormat::mono16, "Mono16", 0x01100007, "Y16 ", 16, 2},
                                                          {PixelFormat::yuyv, "YUV422_8", 0x02100032, "YUYV", 8, 2}};

/// The line of the table.
[[nodiscard]] constexpr const PixelFormatFacts& facts_of(PixelFormat format) {
  for (const auto& facts : pixel_format_table) {
    if (facts.format == format) return facts;
  }
  return pixel_format_table[0];  // not reached: every format has a line
}

/// Of pixels with two bytes of counts (mono10, 12, 14, 16); the other formats have one order only and ignore it.
enum class ByteOrder { little_endian, big_endian };

/// PFNC name, e.g. "Mono14"; "YUV422_8" for yuyv.
[[nodiscard]] constexpr std::string_view to_string(PixelFormat format) {
  return facts_of(format).name;
}
/// The PFNC code, and back.
[[nodiscard]] constexpr std::uint32_t pfnc_code(PixelFormat format) {
  return facts_of(format).pfnc;
}
[[nodiscard]] std::optional<PixelFormat> pixel_format_of_pfnc(std::uint32_t code);
[[nodiscard]] constexpr int significant_bits(PixelFormat format) {
  return facts_of(format).significant_bits;
}

/// What a four-character code of V4L2 stands for.
struct FourccFormat {
  PixelFormat format;
  ByteOrder order;
  bool operator==(const FourccFormat&) const = default;
};
/// "Y16 ", "Y16 " with bit 31 set (big-endian, listed as "Y16 -BE"), "Y14 ", "Y12 ", "Y10 ", "GREY", "YUYV"; nothing
/// for any other. The code is v4l2_fourcc(): first character in the low byte.
[[nodiscard]] std::optional<FourccFormat> format_of_fourcc(std::uint32_t fourcc);
/// The code of a format, low byte first where there is an order.
[[nodiscard]] std::uint32_t fourcc_code(PixelFormat format);

/// A picture in memory.
struct PixelLayout {
  PixelFormat format = PixelFormat::mono16;
  ByteOrder order = ByteOrder::little_endian;
  int width = 0, height = 0;  ///< pixels, 1 ... 65535
  /// From the first byte of a row to the first of the next. 0: rows follow each other without a gap.
  std::size_t row_bytes = 0;
};

/// Bytes that a picture needs. `invalid_input` for an impossible geometry or rows shorter than their pixels.
[[nodiscard]] Result<std::size_t> picture_bytes(const PixelLayout& layout);

/// Counts of a picture, as they are: bits above significant_bits() in two-byte formats are kept, for the integrity gate
/// to see. More bytes than needed are ignored. Errors: `invalid_input` as picture_bytes(), or fewer bytes than needed.
[[nodiscard]] Result<cv::Mat1w> decode_pixels(std::span<const std::uint8_t> bytes, const PixelLayout& layout);

/// The inverse, for devices that send pictures; padding and dropped bytes are zero (128, no colour, for yuyv). Exactly
/// picture_bytes() long. Errors: `invalid_input` as picture_bytes(), a picture of another size, or a pixel that does
/// not fit into significant_bits().
[[nodiscard]] Result<std::vector<std::uint8_t>> encode_pixels(const cv::Mat1w& counts, const PixelLayout& layout);

/// Rows of a frame that mean something of their own: a picture for people above, temperatures below, telemetry last.
struct RowSection {
  int first = 0, count = 0;
};

/// The bytes of a section of a frame of two-byte pixels, to be decoded by itself: cameras of the InfiRay class send
/// 256 x 384 YUYV whose rows 192 ... 383 are 256 x 192 temperatures of 16 bits, little-endian; telemetry rows of a
/// Lepton are 16 bits, as its picture. `row_bytes` as in PixelLayout, never 0 here. `invalid_input` when the section is
/// not inside the bytes.
[[nodiscard]] Result<std::span<const std::uint8_t>> section_bytes(std::span<const std::uint8_t> frame,
                                                                  std::size_t row_bytes, RowSection section);

}  // namespace todbench
