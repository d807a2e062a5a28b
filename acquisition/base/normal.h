// SPDX-License-Identifier: GPL-3.0-or-later
// A quantile of the normal distribution.
#pragma once

namespace todbench {

/// Half a two-sided 95 % interval of a normal distribution, in standard deviations.
inline constexpr double normal_z95 = 1.959963984540054;

}  // namespace todbench
