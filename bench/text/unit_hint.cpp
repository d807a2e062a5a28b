// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/text/unit_hint.h"

#include <array>
#include <cmath>

namespace todbench {
namespace {

/// Alternative unit: a number in `other` times `factor`, plus `offset`, is one in `unit`.
struct OtherUnit {
  std::string_view unit, other;
  double factor;
  double offset = 0;
};
constexpr double celsius_zero_k = 273.15;
constexpr std::array other_units{
    OtherUnit{"um", "mm", 1e3},
    OtherUnit{"um", "nm", 1e-3},
    OtherUnit{"um", "m", 1e6},
    OtherUnit{"mm", "um", 1e-3},
    OtherUnit{"mm", "m", 1e3},
    OtherUnit{"m", "mm", 1e-3},
    OtherUnit{"m", "km", 1e3},
    OtherUnit{"s", "ms", 1e-3},
    OtherUnit{"s", "us", 1e-6},
    OtherUnit{"ms", "s", 1e3},
    OtherUnit{"ms", "us", 1e-3},
    OtherUnit{"us", "ms", 1e3},
    OtherUnit{"us", "s", 1e6},
    OtherUnit{"mrad", "rad", 1e3},
    OtherUnit{"mrad", "urad", 1e-3},
    OtherUnit{"k", "mK", 1e-3},
    OtherUnit{"k", "degrees Celsius", 1, celsius_zero_k},
    OtherUnit{"c", "kelvin", 1, -celsius_zero_k},
    OtherUnit{"hz", "kHz", 1e3},
    OtherUnit{"hz", "mHz", 1e-3},
    OtherUnit{"deg", "mrad", 0.0572957795},
};

/// Returns whether the key ends in the unit after "_" or "-".
bool ends_in(std::string_view key, std::string_view unit) {
  if (!key.ends_with(unit) || key.size() <= unit.size()) return false;
  const char before = key[key.size() - unit.size() - 1];
  return before == '_' || before == '-';
}

}  // namespace

std::string unit_hint(std::string_view key, double value, const NumberRange& range) {
  if (!std::isfinite(value) || range.contains(value)) return {};
  if (value != 0 && std::abs(value) < 1e-100) return range.contains(0) ? "; is 0 meant?" : "";
  if (value == 0) return {};
  for (const OtherUnit& row : other_units) {
    if (ends_in(key, row.unit) && range.contains(value * row.factor + row.offset))
      return "; is the value in " + std::string(row.other) + "?";
  }
  return {};
}

}  // namespace todbench
