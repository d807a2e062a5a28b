// Bytes as cameras send them, to 16-bit counts and back. Pure functions; sizes are checked, nothing is assumed of the
// bytes.
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

/// How the counts of one pixel lie in the bytes. The names are those of the GenICam Pixel Format Naming Convention
/// (PFNC 2.x); Mono12, Mono12p and Mono12Packed are three different things.
enum class PixelFormat {
  mono8,          ///< one byte; V4L2 GREY
  mono10,         ///< two bytes, the low 10 bits
  mono12,         ///< two bytes, the low 12 bits
  mono14,         ///< two bytes, the low 14 bits; V4L2 Y14
  mono16,         ///< two bytes; V4L2 Y16
  mono10p,        ///< a stream of 10-bit numbers, lowest bit first, from pixel to pixel without gaps
  mono12p,        ///< the same with 12 bits
  mono10_packed,  ///< GigE Vision 1.x: two pixels in three bytes: A9..A2, then B1 B0 in bits 5-4 and A1 A0 in 1-0,
                  ///< B9..B2
  mono12_packed,  ///< GigE Vision 1.x: A11..A4, then B3..B0 in bits 7-4 and A3..A0 in 3-0, B11..B4
  yuyv,           ///< two bytes, the first is the luma of the pixel and the second is dropped; V4L2 YUYV
};
inline constexpr PixelFormat all_pixel_formats[] = {
    PixelFormat::mono8,         PixelFormat::mono10,  PixelFormat::mono12,  PixelFormat::mono14,
    PixelFormat::mono16,        PixelFormat::mono10p, PixelFormat::mono12p, PixelFormat::mono10_packed,
    PixelFormat::mono12_packed, PixelFormat::yuyv};

/// Of pixels with two bytes of counts (mono10, 12, 14, 16); the other formats have one order only and ignore it.
enum class ByteOrder { little_endian, big_endian };

/// PFNC name, e.g. "Mono12Packed"; "YUV422_8" for yuyv.
[[nodiscard]] std::string_view to_string(PixelFormat format);
/// By PFNC name; nothing for a name that is not in the list.
[[nodiscard]] std::optional<PixelFormat> pixel_format_named(std::string_view pfnc_name);
/// The 32-bit PFNC code that GigE Vision and USB3 Vision send, and back.
[[nodiscard]] std::uint32_t pfnc_code(PixelFormat format);
[[nodiscard]] std::optional<PixelFormat> pixel_format_of_pfnc(std::uint32_t code);
/// Bits of a pixel that can be set: 8 ... 16.
[[nodiscard]] int significant_bits(PixelFormat format);

/// What a four-character code of V4L2 stands for.
struct FourccFormat {
  PixelFormat format;
  ByteOrder order;
  bool operator==(const FourccFormat&) const = default;
};
/// "Y16 ", "Y16 " with bit 31 set (big-endian, listed as "Y16 -BE"), "Y14 ", "Y12 ", "Y10 ", "GREY", "YUYV"; nothing
/// for any other. The code is v4l2_fourcc(): first character in the low byte.
[[nodiscard]] std::optional<FourccFormat> format_of_fourcc(std::uint32_t fourcc);

/// A picture in memory.
struct PixelLayout {
  PixelFormat format = PixelFormat::mono16;
  ByteOrder order = ByteOrder::little_endian;
  int width = 0, height = 0;  ///< pixels, 1 ... 65535
  /// From the first byte of a row to the first of the next. 0: rows follow each other without a gap; in mono10p,
  /// mono12p and the packed formats a row then begins in the middle of a byte or group when the one before ended there.
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
