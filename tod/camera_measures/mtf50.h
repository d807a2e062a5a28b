// SPDX-License-Identifier: GPL-3.0-or-later
// Frequency at which an MTF is 0.5.
#pragma once

#include <optional>
#include <vector>

#include "acquisition/base/interval.h"
#include "tod/camera_measures/edge_measure.h"

namespace todbench {

/// Lowest frequency at which `values` are 0.5, linear between the tabulated ones; empty if all but the first are above.
[[nodiscard]] std::optional<double> first_half(const std::vector<double>& frequency, const std::vector<double>& values);

/// 95 % interval of `mtf50_per_pitch`: the lowest frequencies at which the ends of the interval of the MTF are 0.5. An
/// end is empty if its MTF is above 0.5 everywhere or not known there.
[[nodiscard]] Interval mtf50_interval(const EdgeMtf& edge);

}  // namespace todbench
