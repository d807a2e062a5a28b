// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/number_format.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace todbench {
namespace {

constexpr int most_decimals = 6;

bool finite(std::optional<double> value) {
  return value && std::isfinite(*value);
}

}  // namespace

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return "–";
  std::string text = fmt::format("{:.{}f}", value, std::clamp(decimals, 0, 17));
  if (text.front() == '-' && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

std::string shown(double value, int decimals) {
  std::string text = fixed(value, decimals);
  return text.front() == '-' ? "−" + text.substr(1) : text;
}

std::string significant(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  if (value == 0) return "0";
  return shown(value, std::max(0, digits - 1 - static_cast<int>(std::floor(std::log10(std::abs(value))))));
}

std::string stated(double value) {
  std::string text = significant(value, 6);
  if (text.find('.') == std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

int decimals_for(std::optional<double> value, const Interval& interval) {
  double width = 0;
  if (finite(interval.low) && finite(interval.high)) {
    width = (*interval.high - *interval.low) / 2;
  } else if (finite(value) && finite(interval.low)) {
    width = *value - *interval.low;
  } else if (finite(value) && finite(interval.high)) {
    width = *interval.high - *value;
  }
  const auto two_digits_of = [](double number) {
    return 1 - static_cast<int>(std::floor(std::log10(std::abs(number))));
  };
  if (std::abs(width) > 0) {
    // If the interval is wider than its value, the digits follow the value.
    const bool wide = finite(value) && *value != 0 && std::abs(width) > std::abs(*value);
    return std::clamp(wide ? two_digits_of(*value) : two_digits_of(width), 0, most_decimals);
  }
  double scale = 0;
  for (const std::optional<double> candidate : {interval.high, interval.low, value})
    if (finite(candidate)) scale = std::abs(*candidate);
  if (scale == 0) return 0;
  return std::clamp(2 - static_cast<int>(std::floor(std::log10(scale))), 0, most_decimals);
}

bool anything_known(std::optional<double> value, const Interval& interval) {
  return finite(value) || finite(interval.low) || finite(interval.high);
}

std::string with_interval(std::optional<double> value, const Interval& interval) {
  const int decimals = decimals_for(value, interval);
  const bool low = finite(interval.low);
  const bool high = finite(interval.high);
  std::string bounds;
  if (low && high) {
    bounds = shown(*interval.low, decimals) + ", " + shown(*interval.high, decimals);
  } else if (low) {
    bounds = "≥ " + shown(*interval.low, decimals);
  } else if (high) {
    bounds = "≤ " + shown(*interval.high, decimals);
  }
  if (!finite(value)) return bounds.empty() ? "–" : low && high ? "[" + bounds + "]" : bounds;
  return shown(*value, decimals) + (bounds.empty() ? "" : " [" + bounds + "]");
}

std::string probability(double p) {
  if (!std::isfinite(p)) return "–";
  return p < 0.001 ? "< 0.001" : shown(p, 3);
}

std::string words(std::string_view name) {
  std::string text(name);
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

}  // namespace todbench
