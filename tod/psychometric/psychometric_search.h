// SPDX-License-Identifier: GPL-3.0-or-later
// Global maximum of the likelihood: a scan of the whole domain, followed by Newton steps from the best scanned points.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "tod/psychometric/psychometric_likelihood.h"

namespace todbench {

/// Table of ln psi and ln(1 - psi) of one link: piecewise polynomials of degree five in u (Hermite, step 1/16). The
/// error is below 1e-7. A lookup takes a fraction of the time of the functions. Use the table for scans and integrals,
/// never for a reported likelihood.
class LinkTable {
 public:
  /// Computes the table of a link.
  explicit LinkTable(const Link& link);
  /// Returns the link.
  [[nodiscard]] const Link& link() const { return link_; }
  /// Returns the ln likelihood of the positive levels. Blank trials are omitted, because they add only a constant.
  [[nodiscard]] double log_likelihood(const PooledCounts& counts, double t, double slope) const;

 private:
  [[nodiscard]] double outside(const PooledLevel& level, double u) const;

  Link link_;
  LogProbabilities low_, high_;  ///< values outside the table
  std::size_t cells_;
  std::vector<double> right_, wrong_;  ///< six coefficients for each cell; the variable is (u - left edge) / step

  friend class CountsTable;
};

/// Table of the ln likelihood of one set of counts with one link. One polynomial combines the correct and the wrong
/// answers of a level, so a value takes a third of the time that LinkTable needs. Construction takes 1 us per level, so
/// use this table only for several hundred values or more.
class CountsTable {
 public:
  /// Computes the table. The arguments must outlive the object.
  CountsTable(const LinkTable& table, const PooledCounts& counts);
  /// Returns the ln likelihood of the positive levels at the thresholds `ts`, which increase, and one slope. The values
  /// are those of LinkTable::log_likelihood().
  [[nodiscard]] std::vector<double> log_likelihoods(std::span<const double> ts, double slope) const;

 private:
  const LinkTable& table_;
  const PooledCounts& counts_;
  std::unique_ptr<double[]> coefficients_;  ///< [level][cell][power]
};

/// Returns the limits of the search in (t, q, lapse). A fixed lapse has equal lower and upper limits.
[[nodiscard]] ParameterBox<3> search_box(std::optional<double> lapse);

/// Slopes and lapses at which the likelihood is scanned.
struct ScanGrid {
  /// ln slope, as in PsychometricPlace.
  std::vector<double> q;
  /// One table for each lapse.
  std::vector<LinkTable> tables;
};
/// Returns the grid for a fixed lapse, or for a free lapse if `lapse` is empty.
[[nodiscard]] ScanGrid scan_grid(PsychometricForm form, std::optional<double> lapse);

/// A point of the scan.
struct ScanNode {
  /// Parameters t, q and lapse.
  PsychometricPlace place{};
  /// ln likelihood from the table.
  double value = 0;
};
/// Result of scan_likelihood().
struct LikelihoodScan {
  /// For each slope of the grid, the point with the highest likelihood over threshold and lapse.
  std::vector<ScanNode> nodes;
  /// Local maxima over threshold and slope, as further starting points of Newton steps.
  std::vector<ScanNode> peaks;
};
/// Scans the whole domain. The spacing of the thresholds is a fixed part of the width of the function at each slope.
/// Thresholds are placed around every level, between neighbouring levels, below the lowest level and above the highest
/// level. The scan therefore finds ridges outside the levels, and steps between two levels.
[[nodiscard]] LikelihoodScan scan_likelihood(const PooledCounts& counts, const ScanGrid& grid);

/// Returns the maximum over the domain. `scan`: scan of the same counts, from which the Newton steps start. If the
/// likelihood increases up to a limit of the slope, the maximum is at that limit.
[[nodiscard]] Maximum<3> global_maximum(const PooledCounts& counts, PsychometricForm form, const LikelihoodScan& scan,
                                        std::optional<double> lapse);

/// Returns the maximum over slope and lapse at one threshold. Slope and lapse are scanned, and Newton steps start from
/// each local maximum.
[[nodiscard]] Maximum<3> profile_maximum(const PooledCounts& counts, PsychometricForm form, const ScanGrid& grid,
                                         std::optional<double> lapse, double t);

}  // namespace todbench
