// SPDX-License-Identifier: GPL-3.0-or-later
// Frequency at which an MTF is 0.5.
#pragma once

#include <optional>
#include <vector>

#include "acquisition/base/interval.h"

namespace todbench {

/// Returns the lowest frequency at which `values` are 0.5, linear between the tabulated frequencies; empty if all but
/// the first are above 0.5.
[[nodiscard]] std::optional<double> first_half(const std::vector<double>& frequency, const std::vector<double>& values);

/// Returns the interval of that frequency: the lowest frequencies at which the ends of the interval of the MTF are 0.5.
/// An end is empty if its MTF is above 0.5 everywhere, or not known there (`low` is 0).
[[nodiscard]] Interval mtf50_interval(const std::vector<double>& frequency, const std::vector<double>& low,
                                      const std::vector<double>& high);

}  // namespace todbench
