// SPDX-License-Identifier: GPL-3.0-or-later
// Assigns the triangles of a run to the detectors on which they were imaged.
#pragma once

#include <span>
#include <vector>

#include "tod/presentation/trial.h"

namespace todbench {

/// Returns the index of a place, from 0, for each trial in order. A place is a group of triangles, from any plates and
/// mountings, that are imaged onto the same detectors. The answers at a place have the same fixed pattern. The position
/// of a triangle in a set-up is the mean of its centroids in the trials. The triangle is assigned to the first existing
/// place whose centroid is closer than half the size of the larger triangle plus `reach_px`. The centroid of a place
/// does not change, so places do not merge. If a trial has no centroid, every triangle of every set-up is a separate
/// place.
[[nodiscard]] std::vector<int> picture_places(std::span<const Trial> trials);

/// Extent of blur and observer's search outside an outline, in pixels.
inline constexpr double reach_px = 1.5;

}  // namespace todbench
