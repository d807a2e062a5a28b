// SPDX-License-Identifier: GPL-3.0-or-later
// Any text as the description of a set, a scene or a target; what is accepted is a set of views that can be drawn.
#include "bench/plan/target_sets.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

using namespace todbench;

/// A picture with a warm block, whatever its name.
cv::Mat1d block() {
  cv::Mat1d kelvin(24, 32, 290.0);
  kelvin(cv::Rect(12, 9, 8, 6)) = 295.0;
  return kelvin;
}

Result<StoredPicture> mask(const std::string&) {
  return StoredPicture{cv::Mat1d(block() - 290), StoredPicture::Kind::numbers};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file(data, size);
  const std::string path = file.path().string();
  const SetReaders readers{[](const std::string&, int) -> Result<cv::Mat1d> { return block(); }, mask};
  if (const auto set = load_target_set(path, readers)) {
    for (const auto& target : set->targets) {
      fuzz::require(target.aspects.size() == set->targets.front().aspects.size());
      for (const auto& aspect : target.aspects) {
        if (!validate(aspect)) continue;
        if (const auto signature = target_signature(aspect, {})) fuzz::require(signature->size_m() > 0);
      }
    }
  }
  if (const auto scene = load_scene(path, mask)) (void)target_signature(*scene, {});
  if (const auto target = load_target(path)) (void)view_of(*target, 45);
  return 0;
}
