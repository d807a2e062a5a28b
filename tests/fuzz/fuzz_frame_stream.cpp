// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as a recording of the bench: opened, and every frame read.
#include "acquisition/recording/frame_stream.h"
#include "acquisition/recording/stream_header.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace todbench;
  if (const auto header = parse_stream_header(fuzz::text_of(data, size))) {
    const auto again = parse_stream_header(stream_header_text(*header));
    fuzz::require(again.has_value() && again->info.scale == header->info.scale);
  }
  const fuzz::MemoryFile file(data, size);
  auto stream = open_frame_stream(file.path());
  if (!stream) return 0;
  const auto source = recorded_source(std::move(stream->recording), Playback::replay);
  if (!source->start()) return 0;
  for (int i = 0; i < 100; ++i) {
    const auto frame = source->next(std::chrono::milliseconds(0));
    if (!frame && frame.error().code == ErrorCode::disconnected) break;
  }
  return 0;
}
