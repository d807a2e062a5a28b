// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as what came for an image of any stated size: the pixels lie within them, or there are none.
#include "acquisition/aravis/image_layout.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace todbench;
  constexpr ChunkLayout layouts[] = {ChunkLayout::none, ChunkLayout::big_endian, ChunkLayout::little_endian};
  constexpr std::size_t head = 5;
  if (size < head) return 0;
  const StatedImage image{.format = PixelFormat::mono16,
                          .width = data[0] - 1,
                          .height = data[1] - 1,
                          .x_padding = data[2] - 1,
                          .y_padding = data[3] - 1};
  const std::span received(data + head, size - head);

  const auto found = image_bytes(received, image, layouts[data[4] % 3]);

  if (!found) return 0;
  fuzz::require(found->data() == received.data() && found->size() <= received.size());
  const auto counts = decode_pixels(*found, {.format = image.format,
                                             .order = ByteOrder::little_endian,
                                             .width = image.width,
                                             .height = image.height,
                                             .row_bytes = row_bytes(image)});
  fuzz::require(counts.has_value());
  return 0;
}
