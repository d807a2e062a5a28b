// Any bytes as what a Seek camera sends: as they are, and repeated until they fill a frame; read, its dead pixels found
// and filled, corrected by a shutter picture.
#include <algorithm>
#include <vector>

#include "acquisition/usb/seek_protocol.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

using namespace todbench;

void read_and_correct(std::span<const std::uint8_t> bytes, SeekModel model) {
  const auto frame = parse_seek_frame(bytes, model);
  fuzz::require(frame.has_value());
  fuzz::require(frame->picture.size() == geometry(model).picture.size());
  fuzz::require(seek_counter(bytes, model) == frame->counter);

  const SeekDeadPixels dead(frame->picture);
  fuzz::require(dead.count() <= frame->picture.total());
  const cv::Mat1w shutter(frame->picture.size(), frame->picture(0, 0));
  const cv::Mat1w corrected = corrected_seek_picture(frame->picture, shutter, dead);
  fuzz::require(corrected.size() == frame->picture.size());
  // Where one pixel lives every dead one is filled from it, and none stays as it was sent.
  cv::Mat1w filled = frame->picture.clone();
  dead.fill(filled);
  fuzz::require(dead.count() == frame->picture.total() || std::find(filled.begin(), filled.end(), 0) == filled.end());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const SeekModel model = data[0] % 2 == 0 ? SeekModel::compact : SeekModel::compact_pro;
  const std::span<const std::uint8_t> sent(data + 1, size - 1);
  const std::size_t whole = geometry(model).frame_bytes();
  fuzz::require(parse_seek_frame(sent, model).has_value() == (sent.size() == whole));
  fuzz::require(seek_counter(sent, model).has_value() == (sent.size() >= 2 * geometry(model).counter_word + 2));
  std::vector<std::uint8_t> frame(whole);
  for (std::size_t i = 0; i < whole; ++i) frame[i] = sent[i % sent.size()];
  read_and_correct(frame, model);
  return 0;
}
