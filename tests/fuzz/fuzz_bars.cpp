// SPDX-License-Identifier: GPL-3.0-or-later
// Any text as the files of people in a session: answers to bars, the index of the kept bars.
#include <fstream>

#include "bench/session/bars_people.h"
#include "bench/session/kept_bars_record.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/support/temporary_folder.h"

namespace {

/// A session folder of this process.
const std::filesystem::path& session() {
  static const todbench::testing::TemporaryFolder folder;
  static const bool ready = !folder.write("people/bars.json", "").empty() &&
                            !folder.write("pictures/mrtd-bars.f32", std::string(512, '\0')).empty();
  todbench::fuzz::require(ready);
  return folder.path();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace todbench;
  for (const char* name : {"people/bars.json", "pictures/mrtd-bars.json"})
    std::ofstream(session() / name, std::ios::binary) << fuzz::text_of(data, size);
  if (const auto sittings = read_bars_sittings(session())) (void)bars_people_json(*sittings);
  if (const auto kept = read_kept_bars(session()); kept && *kept) {
    for (const KeptPicture& picture : (*kept)->pictures) fuzz::require(picture.place < (*kept)->places.size());
  }
  return 0;
}
