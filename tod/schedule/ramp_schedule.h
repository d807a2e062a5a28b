// SPDX-License-Identifier: GPL-3.0-or-later
// Presentations while the contrast decreases and increases: a curve of many contrasts from one pass of every set-up.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "acquisition/base/rng.h"
#include "tod/schedule/schedule.h"

namespace todbench {

/// Time between two shifts in a ramp. With 0.1 s for a motion and 0.04 s discarded, 18 of 25 frames remain; with shifts
/// every 0.2 s only 3 of 10.
inline constexpr double ramp_step_s = 0.5;

/// Presentations at the settled first contrast before the first ramp. Ramps are compared with them (contrast_lag.h).
inline constexpr std::size_t ramp_hold = 20;

/// Options of RampSchedule.
struct RampOptions {
  /// Plates, mountings and pixel; `delta_t_k` are the contrasts of the points, `phases` is not used.
  ConstantStimuliOptions stimuli;
  double from_k = 0, to_k = 0;  ///< of one sign, `to_k` nearer to 0
  double rate_k_per_s = 0;      ///< rate at `from_k`, > 0; it decreases in proportion to the contrast
};

/// Returns the number of presentations of one ramp, from the first contrast to the last.
[[nodiscard]] std::size_t ramp_steps(const RampOptions& options);
/// Returns the relative rate of the contrast, 1/s.
[[nodiscard]] double ramp_relative_rate(const RampOptions& options);

/// Returns `ramp_hold` presentations at `from_k`, followed by one ramp down and one ramp up for every set-up. The
/// shifts are an additive recurrence with a random start, which is even over every part of a ramp. The first
/// presentation of a ramp waits until the contrast is near `from_k`; the others do not wait for a contrast.
[[nodiscard]] std::vector<TargetState> ramp_presentations(const RampOptions& options, const RandomStream& stream);

/// Shows ramp_presentations(). A slow black body lags behind its set-points. Therefore the end of a ramp down is
/// presented again, with further shifts, until the camera observes the last contrast within 10 %, or until the ramp is
/// four times as long.
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
  bool repeats_ = false;  ///< the next state is the last one with another shift
};

}  // namespace todbench
