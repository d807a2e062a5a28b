// SPDX-License-Identifier: GPL-3.0-or-later
// Lag between the small and the large triangles of a plate while the contrast of a ramp changes.
#pragma once

#include <optional>
#include <span>

#include "tod/presentation/presentation.h"

namespace todbench {

/// Estimated lag in seconds. Positive: small triangles change later than large triangles.
struct LagEstimate {
  double lag_s = 0;
  double standard_error_s = 0;
  double degrees_of_freedom = 1;
  /// Returns the deviation of `lag_s` that is exceeded by chance with probability 1/300. For the three estimates of a
  /// run together, the probability is 1 %.
  [[nodiscard]] double chance_s() const;
  /// Returns whether the magnitude of the lag is above `stated_s` plus chance_s().
  [[nodiscard]] bool exceeds(double stated_s) const;
};

/// Lags of a run. The model of the contrast of small triangles is M = r (L - lag dL/dt) + c, where L is the contrast of
/// large triangles and r and c are constants of a set-up. The lag common to ramps up and down is estimated from all
/// set-ups. Separate lags of ramps up and down require presentations at a constant contrast, because ramps alone do not
/// distinguish an error of r from lags of opposite sign.
struct ContrastLag {
  LagEstimate all;                          ///< lag from all set-ups, ramps up and down together
  std::optional<LagEstimate> down{}, up{};  ///< lags of ramps down and up, from the set-up with the held contrast
};

/// Returns the lags by weighted least squares. `step_s`: time between successive presentations, used if the target
/// reports no times. Empty: fewer than three set-ups with twelve usable presentations in ramps.
[[nodiscard]] std::optional<ContrastLag> contrast_lag(std::span<const Presentation> presentations, double step_s);

}  // namespace todbench
