// SPDX-License-Identifier: GPL-3.0-or-later
// Precision of the fit over a ramp, as an equivalent number of presentations at each contrast.
#pragma once

#include <span>
#include <vector>

#include "tod/psychometric/contrast_surface.h"

namespace todbench {

/// Information of a presentation at one contrast about S75, in any unit.
struct ContrastInformation {
  double delta_t_k = 0;
  double information = 0;     ///< weight of its answers in the fit
  double variance_ratio = 1;  ///< variance of a graded answer over the variance of a binary answer
};

/// Returns an equivalent number of presentations for each of `points`, at least 1: this number in each set-up, all at
/// the contrast of the point, would determine S75 as precisely as the fit of a ramp (RampFit). `shown_k`: contrasts of
/// the presentations of a set-up. The logarithms of information and ratio are interpolated linearly between the points
/// and are constant beyond the points. Precondition: `points` and `shown_k` are not empty, information > 0, ratios
/// > 0.
[[nodiscard]] std::vector<double> equal_presentations(std::span<const ContrastInformation> points,
                                                      std::span<const double> shown_k, const ContrastNoise& noise);

/// Returns, for each of `points_k`, the number of presentations whose contrast is nearest to this point, by ratio.
[[nodiscard]] std::vector<int> nearest_presentations(std::span<const double> points_k, std::span<const double> shown_k);

}  // namespace todbench
