// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as a picture in any format: decoded, and encoded again to the same counts.
#include <algorithm>
#include <array>

#include "acquisition/core/byte_order.h"
#include "acquisition/pixel_formats/pixel_formats.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace todbench;
  constexpr std::size_t head = 6;
  if (size < head) return 0;
  PixelLayout layout;
  layout.format = pixel_format_table[data[0] % std::size(pixel_format_table)].format;
  layout.order = data[1] % 2 == 0 ? ByteOrder::little_endian : ByteOrder::big_endian;
  layout.width = data[2] - 1;
  layout.height = data[3] - 1;
  layout.row_bytes = static_cast<std::size_t>(data[4]) | static_cast<std::size_t>(data[5]) << 8;
  const std::span<const std::uint8_t> bytes(data + head, size - head);

  const auto counts = decode_pixels(bytes, layout);
  (void)section_bytes(bytes, layout.row_bytes, {.first = data[2] - 3, .count = data[3] - 3});
  (void)format_of_fourcc(static_cast<std::uint32_t>(data[0]) << 24 | static_cast<std::uint32_t>(data[5]));
  if (!counts) return 0;
  (void)byte_order_evidence(*counts, {});
  const auto again = encode_pixels(*counts, layout);
  // Only two-byte formats can hold bits that they do not have.
  const int full_scale = (1 << significant_bits(layout.format)) - 1;
  const bool fits = std::all_of(counts->begin(), counts->end(), [&](std::uint16_t c) { return c <= full_scale; });
  fuzz::require(again.has_value() == fits);
  if (!again) return 0;
  const auto decoded = decode_pixels(*again, layout);
  fuzz::require(decoded.has_value() && std::equal(counts->begin(), counts->end(), decoded->begin()));
  return 0;
}
