// SPDX-License-Identifier: GPL-3.0-or-later
// Transfer function, with intervals, from the samples of an edge.
#pragma once

#include <vector>

#include "tod/measures/edge_line.h"
#include "tod/measures/edge_tails.h"

namespace todbench {

/// Weight of the profile's derivative: 1 up to `flat`, then a cosine that decreases to 0 at `end`.
struct EdgeWindow {
  double flat = 0, end = 0;  ///< pitches from the edge
  [[nodiscard]] double at(double t) const;
};

/// Sums over groups of neighbouring rows, so that each group can be left out.
struct EdgeGroups {
  SplineSums all;
  std::vector<SplineSums> groups;
};
/// Sums the samples by groups of neighbouring rows.
[[nodiscard]] EdgeGroups grouped(const std::vector<EdgeSample>& samples, const SplineGrid& grid, int rows);

/// Tails of the edge's picture, and the profiles of the model's columns at the same pixels.
struct EdgeTails {
  TailFit fit;
  std::vector<Spline> columns;  ///< one per unknown
  double step = 1;              ///< step of the picture for a unit step of the model
  double orientation = 1;       ///< -1: the bright side of the columns has t < 0
};

/// MTF at each frequency with its 95 % interval.
struct EdgeTransfer {
  std::vector<double> mtf, low, high;
  std::vector<bool> low_known;  ///< false: only the bound on halos limits `low`
};
/// Computes the MTF: the modulus of the transform of the profile's derivative within the window, plus the part of the
/// tails outside the window and the region, which is linear in the unknowns of the tails. It is 1 at frequency 0 and
/// corrected for the contribution of noise to a modulus.
///
/// The 95 % intervals combine three contributions: the extremes over all tails within chi-square 5.99 of the best; the
/// noise (jackknife over the groups); and `rounding`, the effect on the profile of counts whose noise is too small to
/// spread them, as a share of the step. `displacement_pitch2`: variance of the lines' positions along the normal in
/// excess of the straight edge. It lowers the measured MTF, so the upper end is raised. Empty if a part cannot be
/// fitted.
[[nodiscard]] EdgeTransfer edge_transfer(const EdgeGroups& groups, const EdgeWindow& window,
                                         const std::vector<double>& frequency_per_pitch, const EdgeTails& tails,
                                         double rounding, double displacement_pitch2);

}  // namespace todbench
