// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as a FLIR SEQ file: opened, and every frame read.
#include "acquisition/recording/flir_seq.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace todbench;
  const fuzz::MemoryFile file(data, size);
  auto recording = open_flir_seq(file.path());
  if (!recording) return 0;
  for (std::uint64_t i = 0; i < recording->frame_count && i < 100; ++i) {
    const auto frame = recording->read(i);
    if (!frame) continue;
    fuzz::require(!frame->counts.empty());
    (void)recording->info.scale.kelvin(frame->counts(0, 0));
  }
  return 0;
}
