// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as what a Seek camera sends: as they are; repeated until they fill a frame; and as a small picture whose
// dead pixels are found and filled, corrected by a shutter picture.
#include <algorithm>
#include <vector>

#include "acquisition/usb/seek_protocol.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

using namespace todbench;

void read_frame(std::span<const std::uint8_t> sent, SeekModel model) {
  std::vector<std::uint8_t> bytes(geometry(model).frame_bytes());
  for (std::size_t done = 0; done < bytes.size(); done += sent.size()) {
    std::copy_n(sent.data(), std::min(sent.size(), bytes.size() - done), bytes.data() + done);
  }
  const auto frame = parse_seek_frame(bytes, model);
  fuzz::require(frame.has_value());
  fuzz::require(frame->picture.size() == geometry(model).picture.size());
  fuzz::require(seek_counter(bytes, model) == frame->counter);
}

/// Small, because what is done with a picture does not depend on its size and takes time that does.
void correct(std::span<const std::uint8_t> sent, int width) {
  constexpr std::size_t most_pixels = 512;
  const std::size_t rows = std::min(sent.size() / 2, most_pixels) / static_cast<std::size_t>(width);
  if (rows == 0) return;
  cv::Mat1w picture(static_cast<int>(rows), width);
  for (int i = 0; i < static_cast<int>(picture.total()); ++i) {
    const auto at = 2 * static_cast<std::size_t>(i);
    picture(i / width, i % width) = static_cast<std::uint16_t>(sent[at] | sent[at + 1] << 8U);
  }
  const SeekDeadPixels dead(picture);
  fuzz::require(dead.count() <= picture.total());
  const cv::Mat1w shutter(picture.size(), picture(0, 0));
  fuzz::require(corrected_seek_picture(picture, shutter, dead).size() == picture.size());
  // Where one pixel lives every dead one is filled from it, and none stays zero.
  dead.fill(picture);
  fuzz::require(dead.count() == picture.total() || std::find(picture.begin(), picture.end(), 0) == picture.end());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t head = 2;
  if (size <= head) return 0;
  const SeekModel model = data[0] % 2 == 0 ? SeekModel::compact : SeekModel::compact_pro;
  const bool whole_frame = data[0] / 2 % 8 == 0;
  const int width = 1 + data[1] % 32;
  const std::span<const std::uint8_t> sent(data + head, size - head);
  const std::size_t counter_ends = 2 * geometry(model).counter_word + 2;
  fuzz::require(parse_seek_frame(sent, model).has_value() == (sent.size() == geometry(model).frame_bytes()));
  fuzz::require(seek_counter(sent, model).has_value() == (sent.size() >= counter_ends));
  if (whole_frame) read_frame(sent, model);
  correct(sent, width);
  return 0;
}
