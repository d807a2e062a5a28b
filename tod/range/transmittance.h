// SPDX-License-Identifier: GPL-3.0-or-later
// Transmittance of the air as a function of range: from a table, a spectrum, or one coefficient.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// A shorter distance (m) is the rounding error of a contrast that equals the lowest contrast of a curve.
inline constexpr double nearest_range_m = 1e-6;

/// One row of a table, for a horizontal path.
struct TransmittancePoint {
  double range_m = 0;        ///< >= 0
  double transmittance = 1;  ///< 0 to 1
};

/// Band transmittance as a function of range. It is not an exponential function of the range: strong lines are absorbed
/// first, so the extinction -ln(transmittance) / range decreases with range. Immutable, thread-safe.
class Transmittance {
 public:
  /// Returns the transmittance exp(-`extinction_per_km` R), with the range R in km.
  [[nodiscard]] static Transmittance beer_lambert(double extinction_per_km);
  /// Interpolates a table. The range must increase from row to row, and the transmittance must not increase. A row at 0
  /// m must have the transmittance 1. Between rows ln(-ln tau) is linear in ln R. Below the first row this line is
  /// continued towards tau = 1. In the intervals next to a row with a transmittance of exactly 1, -ln tau is linear in
  /// R. Rows below 1e-8 are dropped, because 1e-8 is the lower limit of programs that write these tables. Undefined
  /// beyond the last row. Errors: `invalid_input` (no rows, fewer than two usable rows above 0 m, unsorted or repeated
  /// ranges, a transmittance outside 0 to 1, or a transmittance that increases).
  [[nodiscard]] static Result<Transmittance> of_table(std::span<const TransmittancePoint> rows);
  /// Returns the weighted mean of exp(-k_i R) over the extinctions k_i: the law of Beer and Lambert at every
  /// wavelength. The mean is exact at every range. Preconditions: the same number of weights and extinctions, at least
  /// one of each; weights >= 0 and not all 0; extinctions >= 0; all values finite.
  [[nodiscard]] static Transmittance of_spectrum(std::vector<double> weights, std::vector<double> extinction_per_km);

  /// Returns the optical depth -ln tau; empty beyond end_m(). Precondition: range_m >= 0.
  [[nodiscard]] std::optional<double> optical_depth(double range_m) const;
  /// Returns the transmittance tau; empty beyond end_m().
  [[nodiscard]] std::optional<double> at(double range_m) const;
  /// Returns the last range of the table; infinite without a table.
  [[nodiscard]] double end_m() const;
  /// Returns the same air with every optical depth multiplied by `factor`. Use this function to compute the effect of
  /// an error of the extinction. Precondition: factor >= 0.
  [[nodiscard]] Transmittance with_depth_times(double factor) const;

 private:
  struct Row {
    double range_m = 0, depth = 0;
  };
  Transmittance() = default;
  [[nodiscard]] double table_depth(double range_m) const;
  std::vector<Row> rows_;  ///< rows of the table; empty: a spectrum is used
  std::vector<double> weights_, extinction_per_km_;
  double factor_ = 1;
};

}  // namespace todbench
