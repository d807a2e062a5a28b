// SPDX-License-Identifier: GPL-3.0-or-later
// Global maximum of the likelihood: a scan of the whole domain, then Newton steps from every promising place.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "tod/psychometric/psychometric_likelihood.h"

namespace todbench {

/// ln psi and ln(1 - psi) of one link as piecewise quintics in u (Hermite, step 1/16). They are accurate to 1e-7 and
/// several times faster than the functions themselves. For scans and integrals, never for a reported likelihood.
class LinkTable {
 public:
  explicit LinkTable(const Link& link);
  [[nodiscard]] const Link& link() const { return link_; }
  /// Returns the ln likelihood of the positive levels (blank trials add a constant).
  [[nodiscard]] double log_likelihood(const PooledCounts& counts, double t, double slope) const;

 private:
  [[nodiscard]] double outside(const PooledLevel& level, double u) const;

  Link link_;
  LogProbabilities low_, high_;  ///< values outside the table
  std::size_t cells_;
  std::vector<double> right_, wrong_;  ///< six coefficients of (u - left edge) / step for each cell

  friend class CountsTable;
};

/// The ln likelihood of one set of counts with one link. One polynomial combines correct and wrong answers of a level,
/// so each value needs a third of the work of LinkTable. The construction (1 us per level) pays off from some hundred
/// values. Refers to both arguments, which must outlive it.
class CountsTable {
 public:
  CountsTable(const LinkTable& table, const PooledCounts& counts);
  /// Returns the ln likelihood of the positive levels, as LinkTable::log_likelihood, at increasing thresholds `ts` and
  /// one slope.
  [[nodiscard]] std::vector<double> log_likelihoods(std::span<const double> ts, double slope) const;

 private:
  const LinkTable& table_;
  const PooledCounts& counts_;
  std::unique_ptr<double[]> coefficients_;  ///< [level][cell][power]
};

/// Returns the search range in (t, q, lapse). A fixed lapse has equal limits.
[[nodiscard]] ParameterBox<3> search_box(std::optional<double> lapse);

/// Slopes and lapses of the scans.
struct ScanGrid {
  std::vector<double> q;
  std::vector<LinkTable> tables;  ///< one for each lapse
};
/// Returns the grid for a fixed lapse, or for a free lapse if `lapse` is empty.
[[nodiscard]] ScanGrid scan_grid(PsychometricForm form, std::optional<double> lapse);

/// A scanned place with its tabulated likelihood.
struct ScanNode {
  PsychometricPlace place{};
  double value = 0;
};
/// Result of a scan of the whole domain.
struct LikelihoodScan {
  std::vector<ScanNode> nodes;  ///< for each slope of the grid the best place over threshold and lapse
  std::vector<ScanNode> peaks;  ///< maxima over threshold and slope: further starting points for Newton steps
};
/// Scans the whole domain. Thresholds are spaced by the width of the function at that slope. They lie around every
/// level, in every gap and outside the ends, so that no step between two levels and no ridge outside them is missed.
[[nodiscard]] LikelihoodScan scan_likelihood(const PooledCounts& counts, const ScanGrid& grid);

/// Returns the maximum over the domain, starting from its scan. If the likelihood increases towards a slope limit, the
/// place is at that limit.
[[nodiscard]] Maximum<3> global_maximum(const PooledCounts& counts, PsychometricForm form, const LikelihoodScan& scan,
                                        std::optional<double> lapse);

/// Returns the maximum over slope and lapse at one threshold, from a scan over both and Newton steps from each local
/// maximum.
[[nodiscard]] Maximum<3> profile_maximum(const PooledCounts& counts, PsychometricForm form, const ScanGrid& grid,
                                         std::optional<double> lapse, double t);

}  // namespace todbench
