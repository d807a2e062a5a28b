// Bars of an MRTD target and what they are told apart from: as edges, and what an ideal observer makes of them.
#pragma once

#include <vector>

#include "hvs/shape/painted_shapes.h"
#include "hvs/shape/polygon_image.h"
#include "tod/range/mrtd_formula.h"

namespace todbench {

/// All fill the same square, of side 3.5 / f.
enum class BarPattern {
  four_bars,  ///< width 1 / (2 f), spaces as wide, 7 : 1
  five_bars,  ///< of the same square: 9/7 of the frequency (Bijl and Valeton)
  uniform     ///< the square at 4/7 of the contrast: as much in all
};

/// Edges in pitches, the middle of the square at the origin, contrast 1. Horizontal: bars along y, which the horizontal
/// axis resolves. Precondition: frequency > 0.
[[nodiscard]] std::vector<StepEdge> bar_edges(BarPattern pattern, double frequency_per_pitch, BarAxis axis);

/// Sums over all samples of the squared difference between four bars and the alternative behind `transfer` (cycles per
/// pitch), contrast 1, one sample a pitch; for each of phases x phases lattices (i + 1/2) / phases - 1/2. Exact but for
/// the cut at `band_per_pitch`.
[[nodiscard]] std::vector<double> bar_energies(double frequency_per_pitch, BarPattern alternative,
                                               const TransferFunction& transfer, double band_per_pitch, int phases);

/// Contrast over noise (sd 1 per sample) at which an ideal observer that knows the phase is right in `proportion` of
/// two-interval decisions, Phi(c sqrt(E / 2)) averaged over the phases. Precondition: energies > 0, proportion between
/// 0.5 and 1.
[[nodiscard]] double ideal_two_interval_contrast(const std::vector<double>& energies, double proportion);
/// What that observer gets right at a contrast over noise.
[[nodiscard]] double ideal_two_interval_proportion(const std::vector<double>& energies, double contrast);

}  // namespace todbench
