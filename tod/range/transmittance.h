// SPDX-License-Identifier: GPL-3.0-or-later
// Transmittance of the air as a function of range: from a table, a spectrum, or one coefficient.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// One row of a table, for a horizontal path.
struct TransmittancePoint {
  double range_m = 0;        ///< >= 0
  double transmittance = 1;  ///< 0 to 1
};

/// Band transmittance as a function of range. The mean over a band is not exponential: strong lines are absorbed first,
/// and the effective extinction -ln(tau) / R decreases with range. Immutable, thread-safe.
class Transmittance {
 public:
  /// Returns the transmittance exp(-K R).
  [[nodiscard]] static Transmittance beer_lambert(double extinction_per_km);
  /// Interpolates rows in which range increases and transmittance does not increase; a row at 0 m has 1. Between rows
  /// ln(-ln tau) is linear in ln R, and it continues below the first row towards tau = 1. Next to a row of exactly 1,
  /// -ln tau is linear in R. Rows below 1e-8 are dropped, because programs that write tables have a lower limit there.
  /// Undefined beyond the last row. Errors: `invalid_input` in one sentence (no rows, fewer than two usable ones above
  /// 0 m, unsorted or repeated ranges, a transmittance that is outside 0 to 1 or increases).
  [[nodiscard]] static Result<Transmittance> of_table(std::span<const TransmittancePoint> rows);
  /// Returns the weighted mean of exp(-k_i R): Beer and Lambert at every wavelength. Exact at every range.
  /// Preconditions: as many weights as extinctions, at least one; weights >= 0 and not all 0, extinctions >= 0, all
  /// finite.
  [[nodiscard]] static Transmittance of_spectrum(std::vector<double> weights, std::vector<double> extinction_per_km);

  /// Returns the optical depth -ln tau; empty beyond end_m(). Precondition: range_m >= 0.
  [[nodiscard]] std::optional<double> optical_depth(double range_m) const;
  /// Returns the transmittance tau; empty beyond end_m().
  [[nodiscard]] std::optional<double> at(double range_m) const;
  /// Returns the last range of the table; infinite without a table.
  [[nodiscard]] double end_m() const;
  /// Returns the same air with every optical depth multiplied, for the effect of an error of the extinction.
  /// Precondition: factor >= 0.
  [[nodiscard]] Transmittance with_depth_times(double factor) const;

 private:
  struct Row {
    double range_m = 0, depth = 0;
  };
  Transmittance() = default;
  [[nodiscard]] double table_depth(double range_m) const;
  std::vector<Row> rows_;  ///< empty: the spectrum
  std::vector<double> weights_, extinction_per_km_;
  double factor_ = 1;
};

}  // namespace todbench
