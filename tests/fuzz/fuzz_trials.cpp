// SPDX-License-Identifier: GPL-3.0-or-later
// Any text as trials and as counts; trials that are accepted are written and read again to the same.
#include "bench/session/trials_csv.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace todbench;
  (void)parse_levels(fuzz::text_of(data, size), "levels.csv");
  const fuzz::MemoryFile file(data, size);
  const auto trials = read_trials(file.path());
  if (!trials) return 0;
  const fuzz::MemoryFile copy(nullptr, 0);
  {
    auto writer = TrialsWriter::create(copy.path());
    fuzz::require(writer.has_value());
    for (const auto& trial : *trials) {
      if (!writer->append(trial)) return 0;
    }
  }
  const auto again = read_trials(copy.path());
  fuzz::require(again.has_value() && again->size() == trials->size());
  return 0;
}
