// SPDX-License-Identifier: GPL-3.0-or-later
// Hint at a different unit for a number that is out of range.
#pragma once

#include <string>
#include <string_view>

#include "acquisition/base/number_range.h"

namespace todbench {

/// Returns "; is the value in mm?" for `wavelength_min_um` = 0.0075. For this, the function replaces the unit at the
/// end of the key or option by its neighbours until the number is in range. Returns "; is 0 meant?" for a number too
/// small for any unit if the range contains 0. Otherwise empty.
[[nodiscard]] std::string unit_hint(std::string_view key, double value, const NumberRange& range);

}  // namespace todbench
