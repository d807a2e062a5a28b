// SPDX-License-Identifier: GPL-3.0-or-later
// Any text as the description of a sensor.
#include "bench/plan/descriptions.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace todbench;
  (void)parse_sensor({.origin = "sensor.toml", .text = std::string(fuzz::text_of(data, size))});
  return 0;
}
