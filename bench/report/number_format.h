// Numbers as people read them: independent of the locale, to the digits their interval supports, never NaN.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// `decimals` digits behind the point, ASCII, "-0.00" becomes "0.00". A dash for a value that is not finite.
[[nodiscard]] std::string fixed(double value, int decimals);

/// As fixed(), with the sign U+2212, for text.
[[nodiscard]] std::string shown(double value, int decimals);

/// To `digits` significant digits, without exponent: 0.0702, 16.9, 1500.
[[nodiscard]] std::string significant(double value, int digits);

/// A number that someone stated, without trailing zeros: up to six significant digits, 20, 0.25, 47.5.
[[nodiscard]] std::string stated(double value);

/// Digits behind the point at which half the width of the interval keeps two significant digits (JCGM 100:2008, 7.2.6).
/// With one side open the distance from the value to the bound counts; without any width three significant digits of
/// the value.
[[nodiscard]] int decimals_for(std::optional<double> value, const Interval& interval);

/// "0.480 [0.468, 0.493]"; with one side open "0.480 [≥ 0.468]"; without a value "≥ 0.468"; a dash when nothing is
/// known.
[[nodiscard]] std::string with_interval(std::optional<double> value, const Interval& interval);

/// Whether there is a value or a bound.
[[nodiscard]] bool anything_known(std::optional<double> value, const Interval& interval);

/// "0.032", "< 0.001".
[[nodiscard]] std::string probability(double p);

/// Names of reasons and verdicts as words: underscores become spaces.
[[nodiscard]] std::string words(std::string_view name);

}  // namespace todbench
