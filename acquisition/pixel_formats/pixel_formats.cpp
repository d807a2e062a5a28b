// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/pixel_formats/pixel_formats.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <utility>

#include "acquisition/base/try.h"

namespace todbench {
namespace {

static_assert(std::endian::native == std::endian::little, "pixels of two bytes are copied as they lie in memory");

/// Pixels of `bits` bits one after another, the lowest bit first (PFNC 2.4, section on packed formats "p").
void decode_bits(std::span<const std::uint8_t> from, unsigned bits, std::span<std::uint16_t> to) {
  for (std::size_t i = 0; i < to.size(); ++i) {
    const std::size_t first = i * bits, byte = first / 8;
    // A pixel lies in two bytes: 12 bits begin at bit 0 or 4, 10 bits at an even bit up to 6.
    const unsigned word = from[byte] | (byte + 1 < from.size() ? from[byte + 1] << 8U : 0U);
    to[i] = static_cast<std::uint16_t>(word >> first % 8 & ((1U << bits) - 1U));
  }
}

void encode_bits(std::span<const std::uint16_t> from, unsigned bits, std::span<std::uint8_t> to) {
  std::fill(to.begin(), to.end(), std::uint8_t{0});
  for (std::size_t i = 0; i < from.size(); ++i) {
    const std::size_t first = i * bits, byte = first / 8;
    const unsigned word = static_cast<unsigned>(from[i]) << first % 8;
    to[byte] = static_cast<std::uint8_t>(to[byte] | (word & 0xFFU));
    if (byte + 1 < to.size()) to[byte + 1] = static_cast<std::uint8_t>(to[byte + 1] | word >> 8U);
  }
}

/// Two pixels in three bytes (GigE Vision 1.2, Mono10Packed and Mono12Packed): high bits of the first, low bits of both
/// (those of the second four bits higher), high bits of the second.
void decode_pairs(std::span<const std::uint8_t> from, unsigned low_bits, std::span<std::uint16_t> to) {
  const unsigned mask = (1U << low_bits) - 1U;
  for (std::size_t i = 0; i < to.size(); ++i) {
    const std::size_t triple = i / 2 * 3;
    const bool second = i % 2 != 0;
    const unsigned high = from[triple + (second ? 2 : 0)];
    const unsigned low = from[triple + 1] >> (second ? 4U : 0U) & mask;
    to[i] = static_cast<std::uint16_t>(high << low_bits | low);
  }
}

void encode_pairs(std::span<const std::uint16_t> from, unsigned low_bits, std::span<std::uint8_t> to) {
  std::fill(to.begin(), to.end(), std::uint8_t{0});
  const unsigned mask = (1U << low_bits) - 1U;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const std::size_t triple = i / 2 * 3;
    const bool second = i % 2 != 0;
    to[triple + (second ? 2 : 0)] = static_cast<std::uint8_t>(from[i] >> low_bits);
    to[triple + 1] = static_cast<std::uint8_t>(to[triple + 1] | (from[i] & mask) << (second ? 4U : 0U));
  }
}

void swap_bytes(std::span<std::uint16_t> words) {
  for (auto& word : words) word = static_cast<std::uint16_t>(word << 8 | word >> 8);
}

void decode_run(std::span<const std::uint8_t> from, const PixelLayout& layout, std::span<std::uint16_t> to) {
  switch (layout.format) {
    case PixelFormat::mono8:
      std::copy_n(from.begin(), to.size(), to.begin());
      return;
    case PixelFormat::yuyv:
      for (std::size_t i = 0; i < to.size(); ++i) to[i] = from[2 * i];
      return;
    case PixelFormat::mono10p:
      return decode_bits(from, 10, to);
    case PixelFormat::mono12p:
      return decode_bits(from, 12, to);
    case PixelFormat::mono10_packed:
      return decode_pairs(from, 2, to);
    case PixelFormat::mono12_packed:
      return decode_pairs(from, 4, to);
    default:
      std::memcpy(to.data(), from.data(), to.size_bytes());
      if (layout.order == ByteOrder::big_endian) swap_bytes(to);
  }
}

void encode_run(std::span<const std::uint16_t> from, const PixelLayout& layout, std::span<std::uint8_t> to) {
  switch (layout.format) {
    case PixelFormat::mono8:
      for (std::size_t i = 0; i < from.size(); ++i) to[i] = static_cast<std::uint8_t>(from[i]);
      return;
    case PixelFormat::yuyv:
      for (std::size_t i = 0; i < from.size(); ++i) {
        to[2 * i] = static_cast<std::uint8_t>(from[i]);
        to[2 * i + 1] = 128;
      }
      return;
    case PixelFormat::mono10p:
      return encode_bits(from, 10, to);
    case PixelFormat::mono12p:
      return encode_bits(from, 12, to);
    case PixelFormat::mono10_packed:
      return encode_pairs(from, 2, to);
    case PixelFormat::mono12_packed:
      return encode_pairs(from, 4, to);
    default:
      std::memcpy(to.data(), from.data(), from.size_bytes());
      if (layout.order == ByteOrder::little_endian) return;
      for (std::size_t i = 0; i + 1 < to.size(); i += 2) std::swap(to[i], to[i + 1]);
  }
}

/// Runs of pixels without gaps: the whole picture, or its rows.
struct Runs {
  std::size_t count = 0, pixels = 0, stride_bytes = 0;
};

Runs runs_of(const PixelLayout& layout) {
  const auto width = static_cast<std::size_t>(layout.width), height = static_cast<std::size_t>(layout.height);
  return layout.row_bytes == 0 ? Runs{1, width * height, 0} : Runs{height, width, layout.row_bytes};
}

std::string described(const PixelLayout& layout) {
  return std::to_string(layout.width) + " x " + std::to_string(layout.height) + " " +
         std::string(to_string(layout.format));
}

constexpr std::uint32_t fourcc(const char* text) {
  std::uint32_t code = 0;
  for (int i = 3; i >= 0; --i) code = (code << 8) | static_cast<std::uint8_t>(text[i]);
  return code;
}

}  // namespace

std::optional<PixelFormat> pixel_format_of_pfnc(std::uint32_t code) {
  for (const auto& facts : pixel_format_table) {
    if (facts.pfnc == code) return facts.format;
  }
  return std::nullopt;
}

std::optional<FourccFormat> format_of_fourcc(std::uint32_t code) {
  // The kernel defines a big-endian format only for Y16.
  constexpr std::uint32_t big_endian = 1u << 31;
  if (code == (fourcc_code(PixelFormat::mono16) | big_endian)) {
    return FourccFormat{PixelFormat::mono16, ByteOrder::big_endian};
  }
  for (const auto& facts : pixel_format_table) {
    if (facts.fourcc != nullptr && fourcc(facts.fourcc) == code)
      return FourccFormat{facts.format, ByteOrder::little_endian};
  }
  return std::nullopt;
}

std::uint32_t fourcc_code(PixelFormat format) {
  const char* text = facts_of(format).fourcc;
  return text == nullptr ? 0 : fourcc(text);
}

Result<std::size_t> picture_bytes(const PixelLayout& layout) {
  constexpr int most = 65535;
  if (layout.width < 1 || layout.height < 1 || layout.width > most || layout.height > most) {
    return fail(ErrorCode::invalid_input, described(layout) + ": impossible size");
  }
  const auto width = static_cast<std::size_t>(layout.width);
  const std::size_t row = bytes_of_pixels(layout.format, width);
  if (layout.row_bytes == 0) return bytes_of_pixels(layout.format, width * static_cast<std::size_t>(layout.height));
  // Rows of a gigabyte are a mistake; the limit prevents an overflow of the product.
  if (layout.row_bytes < row || layout.row_bytes > (std::size_t{1} << 30)) {
    return fail(ErrorCode::invalid_input, described(layout) + ": rows of " + std::to_string(layout.row_bytes) +
                                              " bytes, expected at least " + std::to_string(row));
  }
  return layout.row_bytes * static_cast<std::size_t>(layout.height - 1) + row;
}

Result<cv::Mat1w> decode_pixels(std::span<const std::uint8_t> bytes, const PixelLayout& layout) {
  TODBENCH_TRY(const auto needed, picture_bytes(layout));
  if (bytes.size() < needed) {
    return fail(ErrorCode::invalid_input, described(layout) + " needs " + std::to_string(needed) + " bytes, found " +
                                              std::to_string(bytes.size()));
  }
  cv::Mat1w counts(layout.height, layout.width);
  const auto [runs, pixels, stride] = runs_of(layout);
  for (std::size_t run = 0; run < runs; ++run) {
    decode_run(bytes.subspan(run * stride, bytes_of_pixels(layout.format, pixels)), layout,
               {counts.ptr<std::uint16_t>(static_cast<int>(run)), pixels});
  }
  return counts;
}

Result<std::vector<std::uint8_t>> encode_pixels(const cv::Mat1w& counts, const PixelLayout& layout) {
  TODBENCH_TRY(const auto needed, picture_bytes(layout));
  if (counts.cols != layout.width || counts.rows != layout.height) {
    return fail(ErrorCode::invalid_input, "a picture of " + std::to_string(counts.cols) + " x " +
                                              std::to_string(counts.rows) + " pixels does not match the layout " +
                                              described(layout));
  }
  const unsigned full_scale = (1u << significant_bits(layout.format)) - 1u;
  for (const std::uint16_t value : counts) {
    if (value > full_scale) {
      return fail(ErrorCode::invalid_input,
                  std::to_string(value) + " counts do not fit into " + std::string(to_string(layout.format)));
    }
  }
  std::vector<std::uint8_t> bytes(needed, 0);
  const cv::Mat1w whole = counts.isContinuous() ? counts : cv::Mat1w(counts.clone());
  const auto [runs, pixels, stride] = runs_of(layout);
  for (std::size_t run = 0; run < runs; ++run) {
    encode_run({whole.ptr<std::uint16_t>(static_cast<int>(run)), pixels}, layout,
               std::span(bytes).subspan(run * stride, bytes_of_pixels(layout.format, pixels)));
  }
  return bytes;
}

Result<std::span<const std::uint8_t>> section_bytes(std::span<const std::uint8_t> frame, std::size_t row_bytes,
                                                    RowSection section) {
  const std::size_t rows = row_bytes == 0 ? 0 : frame.size() / row_bytes;
  if (section.first < 0 || section.count < 1 || static_cast<std::size_t>(section.first) > rows ||
      static_cast<std::size_t>(section.count) > rows - static_cast<std::size_t>(section.first)) {
    return fail(ErrorCode::invalid_input, std::to_string(section.count) + " rows from row " +
                                              std::to_string(section.first) + " on are not all among the " +
                                              std::to_string(rows) + " rows of the frame");
  }
  return frame.subspan(static_cast<std::size_t>(section.first) * row_bytes,
                       static_cast<std::size_t>(section.count) * row_bytes);
}

}  // namespace todbench
