// SPDX-License-Identifier: GPL-3.0-or-later
// Any text as a calibration certificate; what is accepted gives a budget row of a finite, positive uncertainty or an
// error.
#include <cmath>

#include "bench/plan/certificate_reader.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace todbench;
  const auto found = parse_certificate(fuzz::text_of(data, size));
  if (!found) {
    fuzz::require(!found.error().message.empty());
    return 0;
  }
  if (const auto row = black_body_row(*found, "", "a.xml"))
    fuzz::require(std::isfinite(row->value) && row->value >= 0 && row->coverage_factor > 0);
  return 0;
}
