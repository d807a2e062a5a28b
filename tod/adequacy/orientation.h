// SPDX-License-Identifier: GPL-3.0-or-later
// Thresholds by the direction of the triangles. Row or column noise, interlaced fields and a tilted lens affect only
// the answers to some directions.
#pragma once

#include <optional>
#include <span>

#include "tod/presentation/trial.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Compares the answers at one contrast by the direction of the triangles in the picture. For the threshold of each
/// direction, the function of the twin is shifted along ln size (one step of the quasi-likelihood estimate,
/// twin_shape_estimate()). The axes (up and down, left and right) are compared within each combination of plate and
/// mounting. The standard error is computed from the scatter over these combinations. Empty with fewer than three
/// combinations, or if a combination has no answers to one of the directions.
[[nodiscard]] std::optional<Orientations> orientations(std::span<const Trial> trials, const ProportionTable& table);

/// Returns a finding if the difference between the axes is significant (two-sided t test at 0.3 %) and above 2 %;
/// otherwise empty. The finding does not make the threshold unfit, because the threshold is the mean over the
/// directions.
[[nodiscard]] std::optional<AdequacyFinding> orientation_finding(const Orientations& found);

}  // namespace todbench
