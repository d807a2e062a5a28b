// SPDX-License-Identifier: GPL-3.0-or-later
// Lag between the small and the large triangles of a plate while the contrast of a ramp changes.
#pragma once

#include <optional>
#include <span>

#include "tod/presentation/presentation.h"

namespace todbench {

/// Estimated lag in seconds, > 0 if small triangles change later than large ones.
struct LagEstimate {
  double lag_s = 0;
  double standard_error_s = 0;
  double degrees_of_freedom = 1;
  /// Returns the distance from `lag_s` that chance exceeds in one of 300: the three estimates of a run together in 1 %.
  [[nodiscard]] double chance_s() const;
  /// Returns whether the magnitude of the lag exceeds the stated one beyond chance.
  [[nodiscard]] bool exceeds(double stated_s) const;
};

/// Lags of a run. The contrast M of small triangles is M = r (L - lag dL/dt) + c, L that of large ones. Ramps up and
/// down give the lag of all set-ups; only presentations with a held contrast tell r apart from a lag that is of
/// opposite sign in ramps up and down.
struct ContrastLag {
  LagEstimate all;                          ///< by set-ups, ramps up and down together
  std::optional<LagEstimate> down{}, up{};  ///< in the set-up with the held contrast
};

/// Returns the lags by weighted least squares; `step_s`: time between successive presentations, used if the target has
/// no times. Empty: fewer than three set-ups with twelve usable presentations in ramps.
[[nodiscard]] std::optional<ContrastLag> contrast_lag(std::span<const Presentation> presentations, double step_s);

}  // namespace todbench
