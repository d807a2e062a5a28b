// SPDX-License-Identifier: GPL-3.0-or-later
// Lag between the small and the large triangles of a plate while the contrast of a ramp changes.
#pragma once

#include <optional>
#include <span>

#include "tod/presentation/presentation.h"

namespace todbench {

/// Estimated lag in seconds, > 0 if small triangles change after large ones.
struct LagEstimate {
  double lag_s = 0;
  double standard_error_s = 0;
  double degrees_of_freedom = 1;
  /// Returns the distance from `lag_s` that chance exceeds with probability 1/300, so 1 % for the three estimates of a
  /// run.
  [[nodiscard]] double chance_s() const;
  /// Returns whether the magnitude of the lag exceeds `stated_s` by more than chance.
  [[nodiscard]] bool exceeds(double stated_s) const;
};

/// Lags of a run. Small triangles have the contrast M = r (L - lag dL/dt) + c, where L is the contrast of large
/// triangles. Ramps up and down yield the lag of all set-ups. Only presentations with a held contrast distinguish r
/// from a lag of opposite sign in ramps up and down.
struct ContrastLag {
  LagEstimate all;                          ///< from all set-ups, ramps up and down together
  std::optional<LagEstimate> down{}, up{};  ///< from the set-up with the held contrast
};

/// Returns the lags by weighted least squares. `step_s`: time between successive presentations, used if the target
/// reports no times. Empty: fewer than three set-ups with twelve usable presentations in ramps.
[[nodiscard]] std::optional<ContrastLag> contrast_lag(std::span<const Presentation> presentations, double step_s);

}  // namespace todbench
