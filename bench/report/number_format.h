// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers as text for readers: independent of the locale, with as many digits as their interval justifies. NaN is shown
// as a dash.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Returns the value in ASCII with `decimals` digits after the point; "-0.00" becomes "0.00"; a dash for a non-finite
/// value.
[[nodiscard]] std::string fixed(double value, int decimals);

/// Returns the same as fixed(), with the minus sign U+2212, for text.
[[nodiscard]] std::string shown(double value, int decimals);

/// Returns `digits` significant digits without exponent: 0.0702, 16.9, 1500.
[[nodiscard]] std::string significant(double value, int digits);

/// Returns a stated number with up to six significant digits and without trailing zeros: 20, 0.25, 47.5.
[[nodiscard]] std::string stated(double value);

/// Returns the number of digits after the point with which the half-width has two significant digits (JCGM 100:2008,
/// 7.2.6), or the value if the half-width exceeds the value. If one limit is open, the distance from the value to the
/// other limit replaces the half-width. Without any width, the value or the limit has three significant digits.
[[nodiscard]] int decimals_for(std::optional<double> value, const Interval& interval);

/// Returns "0.480 [0.468, 0.493]"; "0.480 [≥ 0.468]" if one limit is open; "≥ 0.468" without a value; a dash if value
/// and limits are absent.
[[nodiscard]] std::string with_interval(std::optional<double> value, const Interval& interval);

/// Returns whether there is a value or a bound.
[[nodiscard]] bool anything_known(std::optional<double> value, const Interval& interval);

/// Returns "0.032" or "< 0.001".
[[nodiscard]] std::string probability(double p);

/// Returns the name of a reason or verdict as words: underscores become spaces.
[[nodiscard]] std::string words(std::string_view name);

}  // namespace todbench
