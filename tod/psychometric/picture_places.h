// SPDX-License-Identifier: GPL-3.0-or-later
// Assignment of the triangles of a run to the detectors on which they were imaged.
#pragma once

#include <span>
#include <vector>

#include "tod/presentation/trial.h"

namespace todbench {

/// Returns the index of a place, from 0, for each trial in order. Trials share a place if plates and mountings image
/// their triangles onto the same detectors, because their answers then share fixed pattern. The position of a triangle
/// in a set-up is the mean of its centroids. It belongs to the first earlier place whose centroid is closer than half
/// the size of the larger triangle plus `reach_px`. The place keeps its first centroid, so that places do not merge. If
/// a trial has no centroid, every triangle of every set-up has its own index.
[[nodiscard]] std::vector<int> picture_places(std::span<const Trial> trials);

/// Extent of blur and observer's search outside an outline, in pixels.
inline constexpr double reach_px = 1.5;

}  // namespace todbench
