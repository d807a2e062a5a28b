// SPDX-License-Identifier: GPL-3.0-or-later
// Modulation of four bars after a transfer function and sampling, as a function of the sampling phase.
#pragma once

#include <functional>
#include <vector>

namespace todbench {

/// Four bars of width 1 / (2 f) for the frequency f, with spaces of the same width, contrast 1 and the middle of the
/// group at 0. A real transfer function is applied along the axis across the bars. Immutable, thread-safe.
class BlurredBars {
 public:
  /// Computes the bars. `transfer`: even function of the frequency in cycles per pitch; 1 at frequency 0. Frequencies
  /// above `band_per_pitch` are ignored.
  BlurredBars(double frequency_per_pitch, const std::function<double(double)>& transfer, double band_per_pitch);
  /// Returns the value at a position in pitches, accurate to about 1e-12 within the pattern.
  [[nodiscard]] double at(double x_pitch) const;
  [[nodiscard]] double frequency_per_pitch() const { return frequency_; }

 private:
  double frequency_ = 0;
  std::vector<double> node_frequency_, node_weight_;
};

/// Modulation after sampling: mean of the largest samples of the bars minus mean of the smallest samples of the gaps.
/// The samples of a bar or gap are those within max(w / 2, 1 / 2) of its centre, where w is the width of the bar or
/// gap.
struct BarModulation {
  double best = 0, mean = 0, worst = 0;  ///< over the phases
  double best_phase_pitch = 0;           ///< position of the lattice relative to the middle of the pattern
  int bars_separated_at_best = 1;        ///< 1 + number of gaps that are lower than both neighbouring bars
  double share_of_four = 0;              ///< share of the phases at which four bars are separated
};
/// Computes the modulation at the phases (i + 1/2) / phases - 1/2 pitch. Precondition: phases >= 1.
[[nodiscard]] BarModulation bar_modulation(const BlurredBars& bars, int phases = 64);
/// Computes the modulation of any profile, for example of a measured profile. `profile`: function of the position in
/// pitches, evaluated up to 7 / (4 f) + 1 / 2 from the middle, where f is the frequency.
[[nodiscard]] BarModulation bar_modulation(const std::function<double(double)>& profile, double frequency_per_pitch,
                                           int phases = 64);

}  // namespace todbench
