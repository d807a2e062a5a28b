// SPDX-License-Identifier: GPL-3.0-or-later
// Location of an image among the received bytes, and a check of their number. Pure functions over untrusted bytes.
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
  int x_padding = 0;  ///< bytes after every row
  int y_padding = 0;  ///< bytes after the last row
};

/// Arrangement of the bytes after an image.
enum class ChunkLayout {
  none,           ///< no chunks: every byte belongs to the image
  big_endian,     ///< chunks, each followed by its id and length: GigE Vision
  little_endian,  ///< chunks, each followed by its id and length: USB3 Vision
};

/// Returns the distance between the starts of two rows in bytes. 0 for a packed format without gaps if its rows do not
/// fill whole bytes: neighbouring rows then share a byte.
[[nodiscard]] std::size_t row_bytes(const StatedImage& image);

/// Returns the bytes of the image, padding included. Empty if the number of bytes differs from the stated number,
/// because a row longer than stated would shift every later pixel. In a chunk layout the image is the first chunk,
/// which may be padded to a multiple of eight bytes.
[[nodiscard]] std::optional<std::span<const std::uint8_t>> image_bytes(std::span<const std::uint8_t> received,
                                                                       const StatedImage& image, ChunkLayout chunks);

}  // namespace todbench
