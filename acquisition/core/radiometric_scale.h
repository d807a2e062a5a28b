// SPDX-License-Identifier: GPL-3.0-or-later
// Conversion between counts and kelvin.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// An unknown relation to temperature. Contrasts stay in counts; measurements in kelvin are refused.
struct Uncalibrated {
  bool operator==(const Uncalibrated&) const = default;
};

/// T = offset_k + kelvin_per_count * counts: linear-temperature modes of cameras (0.01, 0.04, 0.1 K per count).
struct LinearScale {
  double kelvin_per_count = 0.01;
  double offset_k = 0;
  bool operator==(const LinearScale&) const = default;
};

/// A measured signal transfer function with strictly increasing counts and temperatures, linear between its points.
struct TableScale {
  std::vector<double> counts;
  std::vector<double> temperature_k;
  bool operator==(const TableScale&) const = default;
};

/// The Planck-like formula that camera makers publish: T = B / ln(R / (S - O) + F), T in kelvin, S in counts.
struct PlanckScale {
  double r = 0, b = 0, f = 1, o = 0;
  bool operator==(const PlanckScale&) const = default;
};

/// Relation between the counts of a frame and temperature. A value type; thread-safe.
class RadiometricScale {
 public:
  RadiometricScale() = default;
  /// Create a scale. Error: `calibration` if the numbers do not define a scale (slope zero or not finite, table not
  /// increasing).
  [[nodiscard]] static Result<RadiometricScale> linear(LinearScale scale);
  [[nodiscard]] static Result<RadiometricScale> table(TableScale scale);
  [[nodiscard]] static Result<RadiometricScale> planck(PlanckScale scale);

  [[nodiscard]] bool calibrated() const { return !std::holds_alternative<Uncalibrated>(scale_); }
  /// Returns the temperature in kelvin; empty outside the scale (uncalibrated, outside the table, S <= O).
  [[nodiscard]] std::optional<double> kelvin(double counts) const;
  /// Returns the scale as a straight line, for loops over whole frames; null if it is not linear.
  [[nodiscard]] const LinearScale* straight_line() const { return std::get_if<LinearScale>(&scale_); }
  /// Returns the counts (not rounded) of a temperature: the inverse of kelvin(); empty outside the scale.
  [[nodiscard]] std::optional<double> counts(double temperature_k) const;
  /// Returns the slope in kelvin per count at `counts`; empty outside the scale.
  [[nodiscard]] std::optional<double> kelvin_per_count(double counts) const;
  /// Returns a text for reports: "0.01 K/count", "table of 7 points", ...
  [[nodiscard]] std::string describe() const;
  bool operator==(const RadiometricScale&) const = default;

  using Parameters = std::variant<Uncalibrated, LinearScale, TableScale, PlanckScale>;
  /// Returns the parameters, for storage.
  [[nodiscard]] const Parameters& parameters() const { return scale_; }

 private:
  explicit RadiometricScale(Parameters scale) : scale_(std::move(scale)) {}
  Parameters scale_;
};

}  // namespace todbench
