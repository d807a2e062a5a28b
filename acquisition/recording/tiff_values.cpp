// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/recording/tiff_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <variant>

#include "acquisition/base/try.h"

namespace todbench {
namespace {

constexpr double zero_celsius_k = 273.15;
constexpr double signed_offset = -32768;
/// Counts 0 and 65535 stay free: they would count as saturated. The lowest value is between the counts 1 and 2.
constexpr double most_steps = 65532;
constexpr std::array steps_k{1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 0.01, 0.02, 0.05, 0.1};

struct ValueRange {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
};

Result<void> widen(ValueRange& range, const cv::Mat& values) {
  if (!cv::checkRange(values, true)) return fail(ErrorCode::invalid_input, "a value is not a number");
  double low = 0, high = 0;
  cv::minMaxLoc(values, &low, &high);
  range.low = std::min(range.low, low);
  range.high = std::max(range.high, high);
  return {};
}

/// Every value must be a whole count, so every picture is read.
Result<ValueCounts> whole_counts(std::uint64_t pictures, const std::function<Result<cv::Mat>(std::uint64_t)>& read) {
  const ValueCounts same{0, 1, ValueUnit::counts};
  for (std::uint64_t k = 0; k < pictures; ++k) {
    TODBENCH_TRY(const auto values, read(k));
    if (auto counts = same.counts(values); !counts) return fail("picture " + std::to_string(k + 1), counts.error());
  }
  return same;
}

Result<ValueCounts> temperature_counts(const ValueRange& range, ValueUnit unit) {
  const double coldest_k = range.low + (unit == ValueUnit::celsius ? zero_celsius_k : 0);
  if (!(coldest_k > 0))
    return fail(ErrorCode::invalid_input,
                unit == ValueUnit::celsius
                    ? fmt::format("the lowest value, {:.6g}, is no temperature in degrees Celsius: state another unit",
                                  range.low)
                    : fmt::format("the lowest value, {:.6g}, is no temperature in kelvin: state unit=celsius if the "
                                  "values are degrees Celsius",
                                  range.low));
  const auto step = std::find_if(steps_k.begin(), steps_k.end(),
                                 [&](double candidate) { return (range.high - range.low) / candidate <= most_steps; });
  if (step == steps_k.end())
    return fail(ErrorCode::invalid_input,
                fmt::format("the values reach from {:.6g} to {:.6g} K: no step up to 0.1 K holds them in 16 bits",
                            range.low, range.high));
  return ValueCounts{(std::floor(range.low / *step) - 1) * *step, *step, unit};
}

}  // namespace

Result<cv::Mat1w> ValueCounts::counts(const cv::Mat& values) const {
  if (values.depth() == CV_16U) return cv::Mat1w(values);
  if (values.depth() == CV_16S) {
    cv::Mat1w shifted;
    values.convertTo(shifted, CV_16U, 1, -offset);
    return shifted;
  }
  cv::Mat1d wide;
  values.convertTo(wide, CV_64F);
  cv::Mat1w counts(wide.size());
  for (int y = 0; y < wide.rows; ++y) {
    for (int x = 0; x < wide.cols; ++x) {
      const double exact = (wide(y, x) - offset) / step, whole = std::nearbyint(exact);
      if (!(whole >= 0 && whole <= 65535))
        return fail(ErrorCode::invalid_input, fmt::format("the value {:.6g} is outside the counts", wide(y, x)));
      if (unit == ValueUnit::counts && whole != exact)
        return fail(ErrorCode::invalid_input,
                    fmt::format("the value {:.6g} is no whole count: state the unit kelvin or celsius", wide(y, x)));
      counts(y, x) = static_cast<ushort>(whole);
    }
  }
  return counts;
}

Result<RadiometricScale> ValueCounts::scale(const RadiometricScale& of_values) const {
  if (unit == ValueUnit::kelvin) return RadiometricScale::linear({step, offset});
  if (unit == ValueUnit::celsius) return RadiometricScale::linear({step, offset + zero_celsius_k});
  const LinearScale* line = of_values.straight_line();
  if (line == nullptr || offset == 0) return of_values;
  return RadiometricScale::linear({line->kelvin_per_count, line->offset_k + offset * line->kelvin_per_count});
}

std::string ValueCounts::describe() const {
  if (unit == ValueUnit::kelvin) return fmt::format("value in K = {:.6g} + {:.6g} count", offset, step);
  if (unit == ValueUnit::celsius) return fmt::format("value in degrees Celsius = {:.6g} + {:.6g} count", offset, step);
  return offset == 0 ? "" : fmt::format("value = count - {:.6g}", -offset);
}

Result<ValueCounts> value_counts(int depth, std::optional<ValueUnit> unit, bool calibrated, std::uint64_t pictures,
                                 const std::function<Result<cv::Mat>(std::uint64_t)>& read) {
  const bool whole = depth == CV_16U || depth == CV_16S;
  if (whole && unit && *unit != ValueUnit::counts)
    return fail(ErrorCode::invalid_input,
                "values of 16 bits are counts: state kelvin_per_count and offset_k in place of the unit");
  if (depth == CV_16U) return ValueCounts{};
  if (!unit && !(whole && calibrated))
    return fail(ErrorCode::invalid_input,
                std::string("the values are ") + (whole ? "signed: state ?unit=counts, or kelvin_per_count and offset_k"
                                                        : "floating point: state ?unit=kelvin, celsius or counts"));
  if (whole) return ValueCounts{signed_offset, 1, {}};
  if (*unit == ValueUnit::counts) return whole_counts(pictures, read);
  if (calibrated)
    return fail(ErrorCode::invalid_input, "the values are temperatures: do not state kelvin_per_count beside the unit");
  ValueRange range;
  for (std::uint64_t k = 0; k < pictures; ++k) {
    TODBENCH_TRY(const auto values, read(k));
    if (auto widened = widen(range, values); !widened) return fail("picture " + std::to_string(k + 1), widened.error());
  }
  return temperature_counts(range, *unit);
}

}  // namespace todbench
