// SPDX-License-Identifier: GPL-3.0-or-later
// A plate of the plan, with an observer prepared for each triangle.
#pragma once

#include <memory>
#include <vector>

#include "hvs/observer/observer.h"
#include "tod/plate/target_plate.h"

namespace todbench {

/// A plate with its observers.
struct PreparedPlate {
  TargetPlate plate;  ///< plate in identity mounting
  /// Observer of each triangle; empty until the scale is known.
  std::vector<std::shared_ptr<const PreparedObserver>> observers;
  std::vector<double> size_px;  ///< size of each triangle
  /// Returns the side of the observer's window of each triangle, in samples.
  [[nodiscard]] std::vector<int> sides() const;
};

/// Prepares the observer for the sizes of the triangles at this scale. Errors: those of the observer, with plate and
/// triangle.
[[nodiscard]] Result<void> prepare(PreparedPlate& plate, Observer& observer, double scale_px_per_mm,
                                   int samples_per_pitch);

}  // namespace todbench
