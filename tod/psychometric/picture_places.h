// SPDX-License-Identifier: GPL-3.0-or-later
// Assignment of the triangles of a run to the detectors on which they were imaged.
#pragma once

#include <span>
#include <vector>

#include "tod/presentation/trial.h"

namespace todbench {

/// Returns the number of a place, from 0 on, for each trial in order. Trials share a place if plates and mountings
/// image their triangles onto the same detectors, so that their answers share fixed pattern. A triangle of a set-up
/// lies at the mean of its centroids. It belongs to the first earlier place whose centroid is nearer than half the size
/// of the larger triangle plus `reach_px`; the place keeps its first centroid, so that places do not merge. If a trial
/// has no centroid, every triangle of every set-up has its own number.
[[nodiscard]] std::vector<int> picture_places(std::span<const Trial> trials);

/// Reach of blur and observer's search outside an outline, in pixels.
inline constexpr double reach_px = 1.5;

}  // namespace todbench
