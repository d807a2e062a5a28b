// SPDX-License-Identifier: GPL-3.0-or-later
// Any text as a sweep; what is accepted expands, and every task has a name of its own.
#include <algorithm>
#include <set>

#include "bench/sweep/sweep.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace todbench;
  auto file = parse_sweep(fuzz::text_of(data, size), "/nowhere/s.toml");
  if (!file) return 0;
  // A sweep of millions is fine and slow.
  if (file->sample_count > 1000 || file->repeats > 1000) return 0;
  for (const auto& axis : file->grid) {
    if (axis.values.size() > 100) return 0;
  }
  if (file->grid.size() > 2) return 0;
  const auto sweep = Sweep::expand(*std::move(file), "", [](std::string_view) { return std::optional<double>(1); });
  if (!sweep) return 0;
  std::set<std::string> names;
  for (std::size_t i = 0; i < std::min<std::size_t>(sweep->count(), 200); ++i)
    fuzz::require(names.insert(sweep->task(i).name).second);
  return 0;
}
