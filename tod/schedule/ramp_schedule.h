// SPDX-License-Identifier: GPL-3.0-or-later
// Presentations while the contrast decreases and increases. One pass of every set-up measures a curve of many
// contrasts.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "acquisition/base/rng.h"
#include "tod/schedule/schedule.h"

namespace todbench {

/// Time between two shifts in a ramp. With 0.1 s for a motion and 0.04 s of discarded frames, 18 of 25 frames are used.
/// If shifts followed every 0.2 s, only 3 of 10 frames would be used.
inline constexpr double ramp_step_s = 0.5;

/// Number of presentations at the settled first contrast before the first ramp. The ramps are compared with these
/// presentations (contrast_lag.h).
inline constexpr std::size_t ramp_hold = 20;

/// Options of RampSchedule.
struct RampOptions {
  /// Plates, mountings and pixel; `delta_t_k` are the contrasts of the points, `phases` is not used.
  ConstantStimuliOptions stimuli;
  double from_k = 0, to_k = 0;  ///< first and last contrast of a ramp down, of the same sign; `to_k` is nearer to 0
  double rate_k_per_s = 0;      ///< rate at `from_k`, > 0; it decreases in proportion to the contrast
};

/// Returns the number of presentations of one ramp, from the first contrast to the last.
[[nodiscard]] std::size_t ramp_steps(const RampOptions& options);
/// Returns the relative rate of the contrast, 1/s.
[[nodiscard]] double ramp_relative_rate(const RampOptions& options);

/// Returns `ramp_hold` presentations at `from_k`, followed by one ramp down and one ramp up for every set-up. The
/// shifts are an additive recurrence with a random start, which spreads them evenly over every part of a ramp. The
/// first presentation of a ramp waits until the contrast is near `from_k`; the other presentations do not wait for a
/// contrast.
[[nodiscard]] std::vector<TargetState> ramp_presentations(const RampOptions& options, const RandomStream& stream);

/// Shows ramp_presentations(). A slow black body lags behind its set-points. The last state of a ramp down is therefore
/// repeated with further shifts, until the observed contrast differs from the last contrast by at most 10 %, or until
/// the ramp has four times its length.
class RampSchedule final : public TrialSchedule {
 public:
  RampSchedule(const RampOptions& options, const RandomStream& stream);
  [[nodiscard]] std::optional<TargetState> next() override;
  [[nodiscard]] std::size_t planned() const override { return states_.size() + repeated_; }
  void observe(std::span<const Trial> trials) override;

 private:
  RampOptions options_;
  std::vector<TargetState> states_;
  std::size_t position_ = 0, repeated_ = 0, repeated_here_ = 0;
  bool repeats_ = false;  ///< true: the next state is the last state with a different shift
};

}  // namespace todbench
