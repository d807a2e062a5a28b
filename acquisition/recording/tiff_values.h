// SPDX-License-Identifier: GPL-3.0-or-later
// Conversion of signed and floating-point values from other programs to counts.
#pragma once

#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "acquisition/base/result.h"
#include "acquisition/core/radiometric_scale.h"

namespace todbench {

/// Unit of the values in a file.
enum class ValueUnit { counts, kelvin, celsius };

/// Conversion of values to counts: count = (value - offset) / step, rounded.
struct ValueCounts {
  double offset = 0, step = 1;
  std::optional<ValueUnit> unit{};  ///< unit of floating-point values

  /// Converts values. Error: `invalid_input` (a value that is not a number, is a fraction although the unit is counts,
  /// or is outside 0 ... 65535 counts).
  [[nodiscard]] Result<cv::Mat1w> counts(const cv::Mat& values) const;
  /// Returns the scale of the counts. `of_values`: scale of the values. Errors as RadiometricScale::linear().
  [[nodiscard]] Result<RadiometricScale> scale(const RadiometricScale& of_values) const;
  /// Returns a text that describes the relation between values and counts, for provenance; empty if values and counts
  /// are equal.
  [[nodiscard]] std::string describe() const;
};

/// Determines the conversion for values of OpenCV's type `depth`. Unsigned values are counts. 32768 is added to signed
/// values. Floating-point values in kelvin or degrees Celsius get the smallest step of the series 1, 2, 5, from 0.1 mK
/// to 0.1 K, that covers their range; this requires reading every picture once. `calibrated`: the user stated a scale.
/// `pictures`: number of pictures. Errors: `invalid_input` (no unit, except for signed values with a scale; a unit that
/// does not fit, fractions stated as counts, a range above 6553 K), those of `read`.
[[nodiscard]] Result<ValueCounts> value_counts(int depth, std::optional<ValueUnit> unit, bool calibrated,
                                               std::uint64_t pictures,
                                               const std::function<Result<cv::Mat>(std::uint64_t)>& read);

}  // namespace todbench
