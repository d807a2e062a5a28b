// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/aravis/image_layout.h"

namespace todbench {
namespace {

/// Id and length after the data of a chunk (GigE Vision 2.0, chapter 24; USB3 Vision 1.0, section 5.6).
constexpr std::size_t chunk_tail_bytes = 8;
constexpr std::size_t chunk_alignment = 8;

std::size_t length_in(std::span<const std::uint8_t> tail, ChunkLayout layout) {
  std::size_t length = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    length = length << 8U | tail[layout == ChunkLayout::big_endian ? 4 + k : 7 - k];
  }
  return length;
}

/// Bytes of the first chunk; empty if the chunks do not fill the received bytes exactly.
std::optional<std::size_t> first_chunk_bytes(std::span<const std::uint8_t> received, ChunkLayout layout) {
  std::size_t end = received.size();
  while (end > chunk_tail_bytes) {
    const std::size_t data_end = end - chunk_tail_bytes;
    const std::size_t length = length_in(received.subspan(data_end, chunk_tail_bytes), layout);
    if (length > data_end) return std::nullopt;
    if (length == data_end) return length;
    end = data_end - length;
  }
  return std::nullopt;
}

}  // namespace

std::size_t row_bytes(const StatedImage& image) {
  const auto width = static_cast<std::size_t>(image.width);
  const bool whole_bytes = width * static_cast<std::size_t>(facts_of(image.format).bits_per_pixel) % 8 == 0;
  if (!whole_bytes && image.x_padding == 0) return 0;
  return bytes_of_pixels(image.format, width) + static_cast<std::size_t>(image.x_padding);
}

std::optional<std::span<const std::uint8_t>> image_bytes(std::span<const std::uint8_t> received,
                                                         const StatedImage& image, ChunkLayout chunks) {
  if (image.width < 1 || image.height < 1 || image.x_padding < 0 || image.y_padding < 0) return std::nullopt;
  const auto height = static_cast<std::size_t>(image.height);
  const std::size_t row = row_bytes(image);
  const std::size_t rows =
      row > 0 ? row * height : bytes_of_pixels(image.format, static_cast<std::size_t>(image.width) * height);
  const std::size_t stated = rows + static_cast<std::size_t>(image.y_padding);
  if (chunks == ChunkLayout::none) return received.size() == stated ? std::optional(received) : std::nullopt;
  const auto first = first_chunk_bytes(received, chunks);
  if (!first || *first < stated || *first - stated >= chunk_alignment) return std::nullopt;
  if (*first != stated && *first % 4 != 0) return std::nullopt;
  return received.first(stated);
}

}  // namespace todbench
