// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison of an observer that has an eye with published results: two ratios between tasks, and the slope of contrast
// discrimination.
#pragma once

#include <vector>

#include "bench/report/vision_page.h"
#include "hvs/eye/contrast_sensitivity.h"

namespace todbench {

/// d' at 84 % correct of two-alternative forced choice.
inline constexpr double two_alternatives = 1.41;
/// d' at about 75 % correct of four-alternative forced choice.
inline constexpr double four_alternatives = 1.68;
/// Share of correct answers at the threshold of four alternatives: the middle between chance and 1.
inline constexpr double acuity_share = 0.625;
/// Luminances assumed for sources that do not state one, and for "high illuminance".
inline constexpr double assumed_cd_m2 = 100, much_light_cd_m2 = 3000;

/// Returns three figures. First: contrast at which a block E is detected, divided by the contrast at which its
/// orientation is recognised. Second: acuity for gratings, divided by the acuity for Landolt rings. Third: slope of
/// contrast discrimination. `ring_acuity_per_arcmin` is the acuity of the same eye for rings at `much_light_cd_m2` and
/// full contrast.
[[nodiscard]] std::vector<VisionKind> vision_ratios(const EyeParameters& eye, double ring_acuity_per_arcmin);

}  // namespace todbench
