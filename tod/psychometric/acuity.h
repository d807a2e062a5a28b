// Acuity from size: the reciprocal, with the bounds exchanged.
#pragma once

#include <optional>

#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Acuity in 1/mrad: 1 / threshold in mrad; nothing where there is no positive threshold.
[[nodiscard]] std::optional<double> acuity_per_mrad(const PsychometricFit& fit);
/// The interval of 1 / S75: the sides change places. A lower limit of 0 is none.
[[nodiscard]] Interval acuity_interval(const Interval& s75_mrad);

}  // namespace todbench
