// Which triangles of a run were seen by the same detectors.
#pragma once

#include <span>
#include <vector>

#include "tod/presentation/trial.h"

namespace todbench {

/// A number from 0 on for each trial, in their order: the same where plates and mountings put triangles before the same
/// detectors, whose fixed pattern their answers share. A triangle of a set-up lies at the mean of its centroids; it is
/// at the place of the first one before whose centroid is nearer than half the size of the larger of both and
/// `reach_px`, so that places do not grow into each other. Where a trial does not say where it was, every triangle of
/// every set-up has a number of its own.
[[nodiscard]] std::vector<int> picture_places(std::span<const Trial> trials);

/// What blur and the search of an observer take in beyond an outline, in pixels.
inline constexpr double reach_px = 1.5;

}  // namespace todbench
