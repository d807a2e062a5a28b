// SPDX-License-Identifier: GPL-3.0-or-later
// Frequency at which an MTF is 0.5.
#pragma once

#include <optional>
#include <vector>

#include "acquisition/base/interval.h"

namespace todbench {

/// Returns the lowest frequency at which the MTF `values` is 0.5, with linear interpolation between the tabulated
/// frequencies. Empty if all values after the first are above 0.5.
[[nodiscard]] std::optional<double> first_half(const std::vector<double>& frequency, const std::vector<double>& values);

/// Returns the interval of the frequency of first_half(). Its limits are the lowest frequencies at which the limits
/// `low` and `high` of the MTF are 0.5. A limit is empty if the MTF limit is above 0.5 everywhere, or is not known at
/// this frequency (`low` is 0).
[[nodiscard]] Interval mtf50_interval(const std::vector<double>& frequency, const std::vector<double>& low,
                                      const std::vector<double>& high);

}  // namespace todbench
