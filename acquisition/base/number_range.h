// SPDX-License-Identifier: GPL-3.0-or-later
// Range of numbers that a key of a description accepts.
#pragma once

#include <limits>
#include <string>

namespace todbench {

/// Range of allowed numbers and its text for messages. NaN and infinity are never allowed.
struct NumberRange {
  enum class Edge { included, excluded };
  double low = std::numeric_limits<double>::lowest();
  double high = std::numeric_limits<double>::max();
  Edge low_edge = Edge::included;
  [[nodiscard]] static constexpr NumberRange any() { return {}; }
  [[nodiscard]] static constexpr NumberRange positive() { return {.low = 0, .low_edge = Edge::excluded}; }
  [[nodiscard]] static constexpr NumberRange not_negative() { return {.low = 0}; }
  [[nodiscard]] static constexpr NumberRange between(double low, double high) { return {.low = low, .high = high}; }
  [[nodiscard]] static constexpr NumberRange above_to(double low, double high) { return {low, high, Edge::excluded}; }
  [[nodiscard]] bool contains(double value) const;
  /// Returns a text for messages: "a number above 0", "a number from 0 to 0.1".
  [[nodiscard]] std::string describe() const;
};

}  // namespace todbench
