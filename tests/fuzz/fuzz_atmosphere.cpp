// SPDX-License-Identifier: GPL-3.0-or-later
// Any text as a table of transmittances, a spectrum or a tape7; what is accepted is a transmittance at every range.
#include <cmath>

#include "bench/plan/atmospheres.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace todbench;
  for (const char* name : {"a.csv", "a.tp7"}) {
    const auto found = parse_atmosphere(fuzz::text_of(data, size), name, {});
    if (!found) continue;
    double before = 1;
    for (double range_m = 0.01; range_m < 1e6; range_m *= 3) {
      const auto tau = found->air.at(range_m);
      if (!tau) break;
      fuzz::require(std::isfinite(*tau) && *tau >= 0 && *tau <= before * (1 + 1e-9));
      before = *tau;
    }
  }
  return 0;
}
