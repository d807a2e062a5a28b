// SPDX-License-Identifier: GPL-3.0-or-later
// Any text as the M75 of people and as a table of people's figures; what is accepted is positive and finite.
#include <algorithm>
#include <cmath>

#include "bench/plan/descriptions.h"
#include "bench/plan/resources.h"
#include "bench/studies/people_set.h"
#include "bench/studies/vision_figures.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace todbench;
  const fuzz::MemoryFile file(data, size);
  if (const auto stated = read_m75_file(file.path())) fuzz::require(std::isfinite(stated->m75) && stated->m75 > 0);
  static const MeasuredEye eye(*parse_observer(find_resource(ResourceKind::observer, "hvs-2").value()).value().eye);
  if (const auto kinds = figures_of_people(file.path(), eye)) {
    for (const VisionKind& kind : *kinds)
      fuzz::require(std::ranges::all_of(kind.points, [](const VisionPoint& p) { return p.people > 0 && p.model > 0; }));
  }
  return 0;
}
