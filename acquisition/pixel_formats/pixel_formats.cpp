#include "acquisition/pixel_formats/pixel_formats.h"

#include <algorithm>
#include <string>

namespace todbench {
namespace {

struct FormatFacts {
  PixelFormat format;
  std::string_view name;
  std::uint32_t pfnc;
  int significant_bits;
  int stored_bits;  ///< on average, per pixel
};

// Codes: PFNC 2.4 (EMVA), the 32-bit values of GigE Vision and USB3 Vision.
constexpr FormatFacts facts[] = {
    {PixelFormat::mono8, "Mono8", 0x01080001, 8, 8},
    {PixelFormat::mono10, "Mono10", 0x01100003, 10, 16},
    {PixelFormat::mono12, "Mono12", 0x01100005, 12, 16},
    {PixelFormat::mono14, "Mono14", 0x01100025, 14, 16},
    {PixelFormat::mono16, "Mono16", 0x01100007, 16, 16},
    {PixelFormat::mono10p, "Mono10p", 0x010A0046, 10, 10},
    {PixelFormat::mono12p, "Mono12p", 0x010C0047, 12, 12},
    {PixelFormat::mono10_packed, "Mono10Packed", 0x010C0004, 10, 12},
    {PixelFormat::mono12_packed, "Mono12Packed", 0x010C0006, 12, 12},
    {PixelFormat::yuyv, "YUV422_8", 0x02100032, 8, 16},
};

const FormatFacts& facts_of(PixelFormat format) {
  return *std::find_if(std::begin(facts), std::end(facts), [&](const FormatFacts& f) { return f.format == format; });
}

/// Bytes of `pixels` pixels that begin at a byte.
std::size_t bytes_for(PixelFormat format, std::size_t pixels) {
  return (pixels * static_cast<std::size_t>(facts_of(format).stored_bits) + 7) / 8;
}

constexpr int packed_bits(PixelFormat format) {
  return format == PixelFormat::mono10p || format == PixelFormat::mono10_packed ? 10 : 12;
}

/// Lowest bit first. At most 12 bits at any bit offset lie in three bytes; the last ones of a row may lie in two.
void decode_stream(std::span<const std::uint8_t> from, int bits, std::span<std::uint16_t> to) {
  const std::uint32_t mask = (1u << bits) - 1u;
  for (std::size_t i = 0; i < to.size(); ++i) {
    const std::size_t bit = i * static_cast<std::size_t>(bits), byte = bit / 8;
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3 && byte + k < from.size(); ++k) word |= std::uint32_t{from[byte + k]} << (8 * k);
    to[i] = static_cast<std::uint16_t>((word >> (bit % 8)) & mask);
  }
}

void encode_stream(std::span<const std::uint16_t> from, int bits, std::span<std::uint8_t> to) {
  for (std::size_t i = 0; i < from.size(); ++i) {
    const std::size_t bit = i * static_cast<std::size_t>(bits), byte = bit / 8;
    const std::uint32_t word = std::uint32_t{from[i]} << (bit % 8);
    for (std::size_t k = 0; k < 3 && byte + k < to.size(); ++k) {
      to[byte + k] = static_cast<std::uint8_t>(to[byte + k] | ((word >> (8 * k)) & 0xffu));
    }
  }
}

/// Two pixels in three bytes: their upper eight bits outside, their lower ones in the middle, the second one's from
/// bit 4 up. An odd last pixel has two bytes.
void decode_groups(std::span<const std::uint8_t> from, int bits, std::span<std::uint16_t> to) {
  const int low_bits = bits - 8;
  const unsigned mask = (1u << low_bits) - 1u;
  for (std::size_t i = 0; i < to.size(); ++i) {
    const std::size_t group = i / 2 * 3;
    const unsigned middle = from[group + 1];
    const bool second = i % 2 == 1;
    const unsigned high = second ? from[group + 2] : from[group];
    to[i] = static_cast<std::uint16_t>((high << low_bits) | ((second ? middle >> 4 : middle) & mask));
  }
}

void encode_groups(std::span<const std::uint16_t> from, int bits, std::span<std::uint8_t> to) {
  const int low_bits = bits - 8;
  const unsigned mask = (1u << low_bits) - 1u;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const std::size_t group = i / 2 * 3;
    const bool second = i % 2 == 1;
    to[second ? group + 2 : group] = static_cast<std::uint8_t>(from[i] >> low_bits);
    to[group + 1] = static_cast<std::uint8_t>(to[group + 1] | ((from[i] & mask) << (second ? 4 : 0)));
  }
}

void decode_run(std::span<const std::uint8_t> from, PixelFormat format, ByteOrder order, std::span<std::uint16_t> to) {
  switch (format) {
    case PixelFormat::mono8:
      std::copy_n(from.begin(), to.size(), to.begin());
      return;
    case PixelFormat::yuyv:
      for (std::size_t i = 0; i < to.size(); ++i) to[i] = from[2 * i];
      return;
    case PixelFormat::mono10p:
    case PixelFormat::mono12p:
      return decode_stream(from, packed_bits(format), to);
    case PixelFormat::mono10_packed:
    case PixelFormat::mono12_packed:
      return decode_groups(from, packed_bits(format), to);
    case PixelFormat::mono10:
    case PixelFormat::mono12:
    case PixelFormat::mono14:
    case PixelFormat::mono16:
      break;
  }
  const std::size_t low = order == ByteOrder::little_endian ? 0 : 1, high = 1 - low;
  for (std::size_t i = 0; i < to.size(); ++i) {
    to[i] = static_cast<std::uint16_t>(from[2 * i + low] | (from[2 * i + high] << 8));
  }
}

void encode_run(std::span<const std::uint16_t> from, PixelFormat format, ByteOrder order, std::span<std::uint8_t> to) {
  switch (format) {
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
    case PixelFormat::mono12p:
      return encode_stream(from, packed_bits(format), to);
    case PixelFormat::mono10_packed:
    case PixelFormat::mono12_packed:
      return encode_groups(from, packed_bits(format), to);
    case PixelFormat::mono10:
    case PixelFormat::mono12:
    case PixelFormat::mono14:
    case PixelFormat::mono16:
      break;
  }
  const std::size_t low = order == ByteOrder::little_endian ? 0 : 1, high = 1 - low;
  for (std::size_t i = 0; i < from.size(); ++i) {
    to[2 * i + low] = static_cast<std::uint8_t>(from[i] & 0xffu);
    to[2 * i + high] = static_cast<std::uint8_t>(from[i] >> 8);
  }
}

std::string described(const PixelLayout& layout) {
  return std::to_string(layout.width) + " x " + std::to_string(layout.height) + " " +
         std::string(to_string(layout.format));
}

std::size_t pixels_of(const PixelLayout& layout) {
  return static_cast<std::size_t>(layout.width) * static_cast<std::size_t>(layout.height);
}

constexpr std::uint32_t fourcc(const char (&text)[5]) {
  std::uint32_t code = 0;
  for (int i = 3; i >= 0; --i) code = (code << 8) | static_cast<std::uint8_t>(text[i]);
  return code;
}

}  // namespace

std::string_view to_string(PixelFormat format) {
  return facts_of(format).name;
}

std::optional<PixelFormat> pixel_format_named(std::string_view pfnc_name) {
  for (const FormatFacts& f : facts) {
    if (f.name == pfnc_name) return f.format;
  }
  return std::nullopt;
}

std::uint32_t pfnc_code(PixelFormat format) {
  return facts_of(format).pfnc;
}

std::optional<PixelFormat> pixel_format_of_pfnc(std::uint32_t code) {
  for (const FormatFacts& f : facts) {
    if (f.pfnc == code) return f.format;
  }
  return std::nullopt;
}

int significant_bits(PixelFormat format) {
  return facts_of(format).significant_bits;
}

std::optional<FourccFormat> format_of_fourcc(std::uint32_t code) {
  constexpr std::uint32_t big_endian = 1u << 31;
  switch (code) {
    case fourcc("Y16 "):
      return FourccFormat{PixelFormat::mono16, ByteOrder::little_endian};
    case fourcc("Y16 ") | big_endian:
      return FourccFormat{PixelFormat::mono16, ByteOrder::big_endian};
    case fourcc("Y14 "):
      return FourccFormat{PixelFormat::mono14, ByteOrder::little_endian};
    case fourcc("Y12 "):
      return FourccFormat{PixelFormat::mono12, ByteOrder::little_endian};
    case fourcc("Y10 "):
      return FourccFormat{PixelFormat::mono10, ByteOrder::little_endian};
    case fourcc("GREY"):
      return FourccFormat{PixelFormat::mono8, ByteOrder::little_endian};
    case fourcc("YUYV"):
      return FourccFormat{PixelFormat::yuyv, ByteOrder::little_endian};
    default:
      return std::nullopt;
  }
}

Result<std::size_t> picture_bytes(const PixelLayout& layout) {
  constexpr int most = 65535;
  if (layout.width < 1 || layout.height < 1 || layout.width > most || layout.height > most) {
    return fail(ErrorCode::invalid_input, described(layout) + ": impossible size");
  }
  if (layout.row_bytes == 0) return bytes_for(layout.format, pixels_of(layout));
  const std::size_t row = bytes_for(layout.format, static_cast<std::size_t>(layout.width));
  // Rows of a gigabyte are a mistake; the limit keeps the product from overflowing.
  if (layout.row_bytes < row || layout.row_bytes > (std::size_t{1} << 30)) {
    return fail(ErrorCode::invalid_input, described(layout) + ": rows of " + std::to_string(layout.row_bytes) +
                                              " bytes, expected " + std::to_string(row) + " or more");
  }
  return layout.row_bytes * static_cast<std::size_t>(layout.height - 1) + row;
}

Result<cv::Mat1w> decode_pixels(std::span<const std::uint8_t> bytes, const PixelLayout& layout) {
  const auto needed = picture_bytes(layout);
  if (!needed) return tl::unexpected(needed.error());
  if (bytes.size() < *needed) {
    return fail(ErrorCode::invalid_input, described(layout) + " needs " + std::to_string(*needed) +
                                              " bytes, there are " + std::to_string(bytes.size()));
  }
  cv::Mat1w counts(layout.height, layout.width);
  if (layout.row_bytes == 0) {
    decode_run(bytes.first(*needed), layout.format, layout.order, {counts.ptr<std::uint16_t>(), pixels_of(layout)});
    return counts;
  }
  const auto width = static_cast<std::size_t>(layout.width);
  const std::size_t used = bytes_for(layout.format, width);
  for (int row = 0; row < layout.height; ++row) {
    decode_run(bytes.subspan(static_cast<std::size_t>(row) * layout.row_bytes, used), layout.format, layout.order,
               {counts.ptr<std::uint16_t>(row), width});
  }
  return counts;
}

Result<std::vector<std::uint8_t>> encode_pixels(const cv::Mat1w& counts, const PixelLayout& layout) {
  const auto needed = picture_bytes(layout);
  if (!needed) return tl::unexpected(needed.error());
  if (counts.cols != layout.width || counts.rows != layout.height) {
    return fail(ErrorCode::invalid_input, "a picture of " + std::to_string(counts.cols) + " x " +
                                              std::to_string(counts.rows) + " is not " + described(layout));
  }
  const unsigned full_scale = (1u << significant_bits(layout.format)) - 1u;
  for (const std::uint16_t value : counts) {
    if (value > full_scale) {
      return fail(ErrorCode::invalid_input,
                  std::to_string(value) + " counts do not fit into " + std::string(to_string(layout.format)));
    }
  }
  std::vector<std::uint8_t> bytes(*needed, 0);
  const cv::Mat1w whole = counts.isContinuous() ? counts : cv::Mat1w(counts.clone());
  if (layout.row_bytes == 0) {
    encode_run({whole.ptr<std::uint16_t>(), pixels_of(layout)}, layout.format, layout.order, bytes);
    return bytes;
  }
  const auto width = static_cast<std::size_t>(layout.width);
  const std::size_t used = bytes_for(layout.format, width);
  for (int row = 0; row < layout.height; ++row) {
    encode_run({whole.ptr<std::uint16_t>(row), width}, layout.format, layout.order,
               std::span(bytes).subspan(static_cast<std::size_t>(row) * layout.row_bytes, used));
  }
  return bytes;
}

Result<std::span<const std::uint8_t>> section_bytes(std::span<const std::uint8_t> frame, std::size_t row_bytes,
                                                    RowSection section) {
  const std::size_t rows = row_bytes == 0 ? 0 : frame.size() / row_bytes;
  if (section.first < 0 || section.count < 1 || static_cast<std::size_t>(section.first) > rows ||
      static_cast<std::size_t>(section.count) > rows - static_cast<std::size_t>(section.first)) {
    return fail(ErrorCode::invalid_input, "rows " + std::to_string(section.first) + " ... +" +
                                              std::to_string(section.count) + " are not among the " +
                                              std::to_string(rows) + " rows of the frame");
  }
  return frame.subspan(static_cast<std::size_t>(section.first) * row_bytes,
                       static_cast<std::size_t>(section.count) * row_bytes);
}

}  // namespace todbench
