// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as a TIFF file: opened, and every page read.
#include "acquisition/recording/tiff_stack.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace todbench;
  const fuzz::MemoryFile file(data, size);
  auto recording = open_tiff_stack(file.path(), {});
  if (!recording) return 0;
  for (std::uint64_t i = 0; i < recording->frame_count && i < 20; ++i) (void)recording->read(i);
  return 0;
}
