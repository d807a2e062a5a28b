// SPDX-License-Identifier: GPL-3.0-or-later
// Modulation of a pattern of four bars in a row of pixels.
#pragma once

#include <span>

#include "acquisition/base/result.h"

namespace todbench {

/// Four bars of width 1 / (2 f) with gaps of the same width, centred at 0 of the axis.
struct FourBars {
  double frequency_per_pitch = 0;  ///< of the bars, in cycles per pitch
  double first_sample_at = 0;      ///< place of samples[0], in pitches from the middle of the pattern
};

struct RowModulation {
  /// Mean over bars of the largest sample within max(1 / (4 f), 1/2) of a bar's centre, minus mean over gaps of the
  /// smallest sample within the same distance of a gap's centre; in the unit of the samples. Negative if bars and gaps
  /// are exchanged.
  double modulation = 0;
  int bars_separated = 1;  ///< 1 + number of gaps whose value is below that of the bars on both sides
};

/// Errors: `invalid_input` (a frequency that is not positive, or samples that do not cover the pattern).
[[nodiscard]] Result<RowModulation> bar_modulation(std::span<const double> samples, const FourBars& bars);

}  // namespace todbench
