// SPDX-License-Identifier: GPL-3.0-or-later
// Transfer function with intervals from the samples of an edge.
#pragma once

#include <vector>

#include "tod/measures/edge_line.h"
#include "tod/measures/edge_tails.h"

namespace todbench {

/// Weight of the profile's derivative: 1 up to `flat`, then falling as a cosine to 0 at `end`.
struct EdgeWindow {
  double flat = 0, end = 0;  ///< pitches from the edge
  [[nodiscard]] double at(double t) const;
};

/// Sums of neighbouring rows, so that each group can be left out.
struct EdgeGroups {
  SplineSums all;
  std::vector<SplineSums> groups;
};
/// Groups of neighbouring rows.
[[nodiscard]] EdgeGroups grouped(const std::vector<EdgeSample>& samples, const SplineGrid& grid, int rows);

/// Tails of the edge's picture, and the profiles of the model's columns at the same pixels.
struct EdgeTails {
  TailFit fit;
  std::vector<Spline> columns;  ///< one per unknown
  double step = 1;              ///< step of the picture for a step of 1 of the model
  double orientation = 1;       ///< -1: the bright side of the columns has t < 0
};

/// MTF at each frequency with its 95 % interval.
struct EdgeTransfer {
  std::vector<double> mtf, low, high;
  std::vector<bool> low_known;  ///< false: only the bound on halos limits `low`
};
/// Modulus of the transform of the profile's derivative within the window, plus the part of the tails outside the
/// window and the region, which is linear in the unknowns of the tails. 1 at frequency 0, corrected for the
/// contribution of noise to a modulus.
///
/// 95 % intervals: the extremes over all tails within chi-square 5.99 of the best, combined with the noise (jackknife
/// over the groups) and with `rounding`, the effect of counts without spreading noise on the profile, as a share of the
/// step. `displacement_pitch2`: variance of the lines' places along the normal in excess of the straight edge; because
/// it lowers the measured MTF, the upper end is raised. Empty if a part cannot be fitted.
[[nodiscard]] EdgeTransfer edge_transfer(const EdgeGroups& groups, const EdgeWindow& window,
                                         const std::vector<double>& frequency_per_pitch, const EdgeTails& tails,
                                         double rounding, double displacement_pitch2);

}  // namespace todbench
