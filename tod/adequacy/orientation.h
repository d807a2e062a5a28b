// SPDX-License-Identifier: GPL-3.0-or-later
// Thresholds by the direction of the triangles: noise of rows or columns, interlaced fields and a tilted lens change
// the answers to some directions only.
#pragma once

#include <optional>
#include <span>

#include "tod/presentation/trial.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Compares the answers of one contrast by the direction of the triangles in the picture. The threshold of each
/// direction is that of the common function of the twin, moved along ln size (one step of the quasi-likelihood
/// estimate, twin_shape_estimate()). The axes are compared within each plate and mounting, whose scatter gives the
/// error. Empty with fewer than three of these, or if a direction is missing in one of them.
[[nodiscard]] std::optional<Orientations> orientations(std::span<const Trial> trials, const ProportionTable& table);

/// A finding if the axes differ by more than chance (two-sided t test at 0.3 %) and by more than 2 %; otherwise empty.
/// The threshold itself remains usable: it is the mean over the directions.
[[nodiscard]] std::optional<AdequacyFinding> orientation_finding(const Orientations& found);

}  // namespace todbench
