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

/// Sums over all samples, and over groups of neighbouring rows, for a jackknife over the groups.
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
  std::vector<bool> low_known;  ///< false: only TailBounds::most_halo determines `low`
};
/// Computes the MTF. The MTF is the modulus of the sum of two parts: the transform of the derivative of the profile
/// within the window, and the transform of the tails outside the window. The second part is linear in the unknowns of
/// the tails. The MTF is 1 at frequency 0, and is corrected for the contribution of noise to a modulus.
///
/// The 95 % intervals combine three contributions: the extremes over all tails with a chi-square of at most 5.99 above
/// the minimum; the noise (jackknife over the groups); and `rounding`. `rounding`: error of the profile, as a share of
/// the step, due to rounding to counts, if the noise is too small to average out the rounding. `displacement_pitch2`:
/// variance of the positions of the lines along the normal relative to the straight edge. This variance lowers the
/// measured MTF, so the upper limit is increased. The result is empty if a part cannot be fitted.
[[nodiscard]] EdgeTransfer edge_transfer(const EdgeGroups& groups, const EdgeWindow& window,
                                         const std::vector<double>& frequency_per_pitch, const EdgeTails& tails,
                                         double rounding, double displacement_pitch2);

}  // namespace todbench
