// SPDX-License-Identifier: GPL-3.0-or-later
// Any text as a plan; one that is accepted is written and read again to the same plan.
#include "bench/plan/plan.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace todbench;
  const std::string text(fuzz::text_of(data, size));
  // Names of files are the user's own: reading what they name is not a matter of parsing.
  if (text.find('/') != std::string::npos) return 0;
  const auto plan = parse_plan({.origin = "plan.toml", .text = text}, "nowhere");
  if (!plan) return 0;
  const auto again = parse_plan({.origin = "again.toml", .text = to_toml(*plan)}, "nowhere");
  fuzz::require(again.has_value() && *again == *plan);
  return 0;
}
