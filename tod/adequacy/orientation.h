// SPDX-License-Identifier: GPL-3.0-or-later
// Thresholds by the direction of the triangles. Row or column noise, interlaced fields and a tilted lens affect the
// answers to some directions only.
#pragma once

#include <optional>
#include <span>

#include "tod/presentation/trial.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Compares the answers at one contrast by the direction of the triangles in the picture. The threshold of each
/// direction comes from the common function of the twin, shifted along ln size (one step of the quasi-likelihood
/// estimate, twin_shape_estimate()). The axes are compared within each combination of plate and mounting; the scatter
/// over these combinations yields the error. Empty with fewer than three combinations, or if a direction is missing in
/// one of them.
[[nodiscard]] std::optional<Orientations> orientations(std::span<const Trial> trials, const ProportionTable& table);

/// Returns a finding if the difference of the axes exceeds chance (two-sided t test at 0.3 %) and 2 %; otherwise empty.
/// The threshold itself remains usable, because it is the mean over the directions.
[[nodiscard]] std::optional<AdequacyFinding> orientation_finding(const Orientations& found);

}  // namespace todbench
