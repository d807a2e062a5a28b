// SPDX-License-Identifier: GPL-3.0-or-later
// Any text as the M75 of people; what is accepted is positive and finite.
#include <cmath>

#include "bench/studies/people_set.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace todbench;
  const fuzz::MemoryFile file(data, size);
  if (const auto stated = read_m75_file(file.path())) fuzz::require(std::isfinite(stated->m75) && stated->m75 > 0);
  return 0;
}
