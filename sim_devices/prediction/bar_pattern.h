// SPDX-License-Identifier: GPL-3.0-or-later
// Four bars of an MRTD target and their alternatives: edges, and performance of an ideal observer.
#pragma once

#include <vector>

#include "hvs/shape/painted_shapes.h"
#include "hvs/shape/polygon_image.h"
#include "tod/range/mrtd_formula.h"

namespace todbench {

/// Pattern of the MRTD target. All patterns fill the same square, of side 3.5 / f for the bar frequency f.
enum class BarPattern {
  four_bars,  ///< bars of width 1 / (2 f), spaces of the same width, bar length 7 times the width
  five_bars,  ///< five bars in the same square, at 9/7 of the frequency (Bijl and Valeton)
  uniform     ///< the square at 4/7 of the contrast, which gives the same mean
};

/// Returns the edges in pitches at contrast 1; the middle of the square is the origin. Horizontal axis: the bars lie
/// along y, so they test the resolution along x. Precondition: frequency > 0.
[[nodiscard]] std::vector<StepEdge> bar_edges(BarPattern pattern, double frequency_per_pitch, BarAxis axis);

/// Returns sums over all samples of the squared difference between four bars and the alternative, after the filter
/// `transfer` (frequencies in cycles per pitch), at contrast 1 and one sample per pitch. One sum for each of phases x
/// phases lattices, displaced by (i + 1/2) / phases - 1/2. Exact except for the truncation at `band_per_pitch`.
[[nodiscard]] std::vector<double> bar_energies(double frequency_per_pitch, BarPattern alternative,
                                               const TransferFunction& transfer, double band_per_pitch, int phases);

/// Returns the ratio c of contrast to noise (sd per sample) at which an ideal observer that knows the phase is correct
/// in `proportion` of two-interval decisions. The proportion is Phi(c sqrt(E / 2)), averaged over the bar_energies() E;
/// Phi: normal distribution. Precondition: energies > 0, proportion between 0.5 and 1.
[[nodiscard]] double ideal_two_interval_contrast(const std::vector<double>& energies, double proportion);
/// Returns the proportion correct of the same observer at a ratio of contrast to noise.
[[nodiscard]] double ideal_two_interval_proportion(const std::vector<double>& energies, double contrast);

}  // namespace todbench
