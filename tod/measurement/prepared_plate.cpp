// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/prepared_plate.h"

namespace todbench {

std::vector<int> PreparedPlate::sides() const {
  std::vector<int> out;
  for (const auto& o : observers) out.push_back(o->window_samples());
  return out;
}

Result<void> prepare(PreparedPlate& plate, Observer& observer, double scale_px_per_mm, int samples_per_pitch) {
  plate.observers.clear();
  plate.size_px.clear();
  for (const auto& t : plate.plate.triangles) {
    const double size_px = t.size_mm * scale_px_per_mm;
    auto prepared = observer.prepare(size_px, samples_per_pitch);
    if (!prepared) return fail("plate " + plate.plate.name + ", " + t.name, prepared.error());
    plate.observers.push_back(*prepared);
    plate.size_px.push_back(size_px);
  }
  return {};
}

}  // namespace todbench
