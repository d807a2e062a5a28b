// Counts to kelvin and back.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

/// No temperature known. Contrasts stay in counts; a measurement in kelvin is refused.
struct Uncalibrated {
  bool operator==(const Uncalibrated&) const = default;
};

/// T = offset_k + kelvin_per_count * counts: the linear-temperature modes of cameras (0.01, 0.04, 0.1 K per count).
struct LinearScale {
  double kelvin_per_count = 0.01;
  double offset_k = 0;
  bool operator==(const LinearScale&) const = default;
};

/// A measured signal transfer function: strictly increasing counts, increasing temperatures, linear between points.
struct TableScale {
  std::vector<double> counts;
  std::vector<double> temperature_k;
  bool operator==(const TableScale&) const = default;
};

/// The Planck-like formula cameras publish: T = B / ln(R / (S - O) + F), S in counts.
struct PlanckScale {
  double r = 0, b = 0, f = 1, o = 0;
  bool operator==(const PlanckScale&) const = default;
};

/// How the counts of a frame relate to temperature. A value; thread-safe.
class RadiometricScale {
 public:
  RadiometricScale() = default;
  /// Fails with `calibration` when the numbers cannot be a scale (zero or non-finite slope, table not increasing).
  [[nodiscard]] static Result<RadiometricScale> linear(LinearScale scale);
  [[nodiscard]] static Result<RadiometricScale> table(TableScale scale);
  [[nodiscard]] static Result<RadiometricScale> planck(PlanckScale scale);

  [[nodiscard]] bool calibrated() const { return !std::holds_alternative<Uncalibrated>(scale_); }
  /// Temperature in kelvin, or nothing where the scale does not reach (uncalibrated, outside the table, S <= O).
  [[nodiscard]] std::optional<double> kelvin(double counts) const;
  /// The scale as a straight line, or null where it is none: for loops over whole frames.
  [[nodiscard]] const LinearScale* straight_line() const { return std::get_if<LinearScale>(&scale_); }
  /// Counts (not rounded) of a temperature; the inverse of kelvin().
  [[nodiscard]] std::optional<double> counts(double temperature_k) const;
  /// Slope in kelvin per count at `counts`.
  [[nodiscard]] std::optional<double> kelvin_per_count(double counts) const;
  /// "0.01 K/count", "table of 7 points", ...: for reports.
  [[nodiscard]] std::string describe() const;
  bool operator==(const RadiometricScale&) const = default;

  using Parameters = std::variant<Uncalibrated, LinearScale, TableScale, PlanckScale>;
  /// What it was made of, to be stored.
  [[nodiscard]] const Parameters& parameters() const { return scale_; }

 private:
  explicit RadiometricScale(Parameters scale) : scale_(std::move(scale)) {}
  Parameters scale_;
};

}  // namespace todbench
