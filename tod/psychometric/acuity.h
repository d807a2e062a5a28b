// SPDX-License-Identifier: GPL-3.0-or-later
// Acuity from size: the reciprocal, with exchanged bounds.
#pragma once

#include <optional>

#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Acuity in 1/mrad: 1 / threshold in mrad; empty without a positive threshold.
[[nodiscard]] std::optional<double> acuity_per_mrad(const PsychometricFit& fit);
/// The interval of 1 / S75 with exchanged sides. A lower limit of 0 gives an open side.
[[nodiscard]] Interval acuity_interval(const Interval& s75_mrad);

}  // namespace todbench
