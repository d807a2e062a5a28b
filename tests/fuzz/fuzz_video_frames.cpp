// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as a frame of a UVC camera that offers any sizes: the layout is chosen, the frame read, its telemetry too.
#include <vector>

#include "acquisition/v4l2/video_layout.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace todbench;
  constexpr std::size_t head = 4;
  constexpr std::uint32_t y16 = 0x20363159, grey = 0x59455247, yuyv = 0x56595559, big_endian = 1U << 31U;
  constexpr std::uint32_t codes[] = {y16, y16 | big_endian, grey, yuyv};
  if (size < head) return 0;
  const std::uint32_t code = codes[data[0] % 4];
  const int width = data[1];
  const int height = data[2];
  const auto family = static_cast<VideoFamily>(data[3] % 4);
  const std::vector<VideoMode> modes{{code, width, height}, {code, width, height + lepton_telemetry_rows(width)}};

  auto layout = choose_layout(modes, family, {});
  if (!layout) return 0;
  layout->row_bytes += data[0] / 4U;  // padding is the driver's
  fuzz::require(layout->picture.area() > 0);
  fuzz::require(layout->picture.y + layout->picture.height + layout->telemetry_rows <= layout->mode.height);
  const auto picture = read_video_frame({data + head, size - head}, *layout);
  if (!picture) return 0;
  fuzz::require(picture->counts.size() == layout->picture.size());
  fuzz::require(layout->telemetry_rows > 0 || !picture->telemetry);
  if (!picture->telemetry) return 0;
  (void)picture->telemetry->since_ffc_s();
  const auto again = parse_lepton_telemetry(encode_lepton_telemetry(*picture->telemetry));
  fuzz::require(again && again->status == picture->telemetry->status);
  fuzz::require(again->kelvin_per_count == picture->telemetry->kelvin_per_count);
  return 0;
}
