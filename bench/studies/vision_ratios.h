// SPDX-License-Identifier: GPL-3.0-or-later
// An observer with an eye against published ratios of two tasks and the published slope of a third.
#pragma once

#include <vector>

#include "bench/report/vision_page.h"
#include "hvs/eye/contrast_sensitivity.h"

namespace todbench {

/// d' at 84 % correct of two-alternative forced choice.
inline constexpr double two_alternatives = 1.41;
/// Share of correct answers in tests with four alternatives: half way from chance.
inline constexpr double acuity_share = 0.625;
/// Luminances of sources that do not state theirs, and of "high illuminance".
inline constexpr double assumed_cd_m2 = 100, much_light_cd_m2 = 3000;

/// Contrast that detects a block E over that which tells its orientation; acuity for gratings over that for Landolt
/// rings; slope of contrast discrimination. `ring_acuity_per_arcmin`: of the eye, at much light and full contrast.
[[nodiscard]] std::vector<VisionKind> vision_ratios(const EyeParameters& eye, double ring_acuity_per_arcmin);

}  // namespace todbench
