// Where the pixels of an image are among the bytes that came for it, and whether these are as many as were stated. Pure
// functions over untrusted bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "acquisition/pixel_formats/pixel_formats.h"

namespace todbench {

/// An image as its leader states it.
struct StatedImage {
  PixelFormat format = PixelFormat::mono16;
  int width = 0, height = 0;
  int x_padding = 0;  ///< bytes behind every row
  int y_padding = 0;  ///< bytes behind the last row
};

/// How the bytes behind an image are arranged.
enum class ChunkLayout {
  none,           ///< there are none: every byte belongs to the image
  big_endian,     ///< chunks, each with its id and length behind it: GigE Vision
  little_endian,  ///< the same: USB3 Vision
};

/// From the first byte of a row to that of the next.
[[nodiscard]] std::size_t row_bytes(const StatedImage& image);

/// The bytes of the image, padding included, out of all that came. Nothing where they are not exactly as many as were
/// stated: a row that is longer than stated would move every pixel behind it. The image of a chunk layout is its first
/// chunk, which may be filled up to a whole number of eight bytes.
[[nodiscard]] std::optional<std::span<const std::uint8_t>> image_bytes(std::span<const std::uint8_t> received,
                                                                       const StatedImage& image, ChunkLayout chunks);

}  // namespace todbench
