// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/plot_ticks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <span>

#include "bench/report/number_format.h"

namespace todbench {
namespace {

// Relative to the range: a tick at the very end of an axis is inside despite rounding.
constexpr double slack = 1e-9;

double power_of_ten(int exponent) {
  return std::pow(10.0, exponent);
}

/// Returns the shortest text of a multiple of 10^exponent.
std::string tick_label(double value, int exponent) {
  return shown(value, std::max(0, -exponent));
}

std::vector<Tick> linear_ticks(double low, double high, int most_labels) {
  const double range = high - low;
  int exponent = static_cast<int>(std::floor(std::log10(range / most_labels)));
  double step = power_of_ten(exponent);
  for (const double factor : {1.0, 2.0, 5.0, 10.0}) {
    step = factor * power_of_ten(exponent);
    if (range / step + 1 <= most_labels + slack) {
      if (factor == 10.0) ++exponent;
      break;
    }
  }
  std::vector<Tick> ticks;
  const double first = std::ceil(low / step - slack);
  for (double i = first; i * step <= high + slack * range; ++i)
    ticks.push_back({i * step, tick_label(i * step, exponent)});
  return ticks;
}

/// Returns the multiples of the decades within the range.
std::vector<Tick> decade_ticks(double low, double high, std::span<const double> multiples) {
  std::vector<Tick> ticks;
  const int last = static_cast<int>(std::floor(std::log10(high)));
  for (int exponent = static_cast<int>(std::floor(std::log10(low))); exponent <= last; ++exponent) {
    for (const double multiple : multiples) {
      const double value = multiple * power_of_ten(exponent);
      const bool whole = multiple == std::floor(multiple);
      if (value >= low * (1 - slack) && value <= high * (1 + slack))
        ticks.push_back({value, tick_label(value, exponent - (whole ? 0 : 1))});
    }
  }
  return ticks;
}

constexpr std::array whole_multiples{1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0};

std::vector<Tick> logarithmic_ticks(double low, double high, int most_labels) {
  static constexpr std::array<double, 1> decades{1};
  static constexpr std::array<double, 2> halves{1, 3};
  static constexpr std::array<double, 3> thirds{1, 2, 5};
  static constexpr std::array<double, 6> sixths{1, 1.5, 2, 3, 5, 7};
  std::vector<Tick> labelled;
  for (const std::span<const double> multiples : {std::span<const double>(decades), std::span<const double>(halves),
                                                  std::span<const double>(thirds), std::span<const double>(sixths)}) {
    std::vector<Tick> denser = decade_ticks(low, high, multiples);
    if (denser.size() <= static_cast<std::size_t>(most_labels)) labelled = std::move(denser);
  }
  if (labelled.size() < 3) return linear_ticks(low, high, most_labels);
  for (Tick minor : decade_ticks(low, high, whole_multiples)) {
    minor.label.clear();
    const bool taken = std::any_of(labelled.begin(), labelled.end(), [&](const Tick& tick) {
      return std::abs(tick.value - minor.value) < slack * minor.value;
    });
    if (!taken) labelled.push_back(minor);
  }
  std::sort(labelled.begin(), labelled.end(), [](const Tick& a, const Tick& b) { return a.value < b.value; });
  return labelled;
}

std::string date_label(double days) {
  const std::chrono::year_month_day date{std::chrono::sys_days(std::chrono::days(std::lround(days)))};
  return fmt::format("{:04d}-{:02d}-{:02d}", static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                     static_cast<unsigned>(date.day()));
}

/// A date is twice as wide as a number.
std::vector<Tick> date_ticks(double low, double high, int most_labels) {
  std::vector<Tick> ticks = linear_ticks(low, high, std::max(2, most_labels / 2));
  std::erase_if(ticks, [](const Tick& tick) { return std::abs(tick.value - std::round(tick.value)) > slack; });
  for (Tick& tick : ticks) tick.label = date_label(tick.value);
  return ticks;
}

}  // namespace

Result<void> validate(const PlotAxis& axis) {
  if (!std::isfinite(axis.low) || !std::isfinite(axis.high) || !(axis.high > axis.low))
    return fail(ErrorCode::invalid_input, "the range of the axis \"" + axis.label + "\" is empty or not finite");
  if (axis.scale == AxisScale::logarithmic && !(axis.low > 0))
    return fail(ErrorCode::invalid_input, "the logarithmic axis \"" + axis.label + "\" does not start above zero");
  return {};
}

std::vector<Tick> axis_ticks(const PlotAxis& axis, int most_labels) {
  if (!axis.ticks.empty()) {
    std::vector<Tick> ticks;
    for (const double value : axis.ticks)
      if (value >= axis.low && value <= axis.high) ticks.push_back({value, stated(value)});
    return ticks;
  }
  if (axis.scale == AxisScale::dates) return date_ticks(axis.low, axis.high, most_labels);
  return axis.scale == AxisScale::linear ? linear_ticks(axis.low, axis.high, most_labels)
                                         : logarithmic_ticks(axis.low, axis.high, most_labels);
}

}  // namespace todbench
