// SPDX-License-Identifier: GPL-3.0-or-later
// Fit of the template observer's parameters to one person's answers.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/observer_fit/observer_values.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Options of fit_person().
struct PersonFitOptions {
  /// Starting point of the search. Parameters that are not free keep these values.
  ObserverValues start{0.6, 0.07, 1, 0};
  std::array<bool, observer_key_count> free{};
  enum class Intervals {
    none,  ///< no intervals, and only a few search steps; for answers with a maximum near the starting point
    profile,
  } intervals = Intervals::profile;
};

/// Result of fit_person().
struct PersonFit {
  ObserverValues values{};  ///< fitted values, by ObserverKey
  std::array<bool, observer_key_count> free{};
  /// 95 % intervals by profile likelihood (drop of 3.84 in twice ln likelihood). A side is open if the likelihood does
  /// not decrease by this drop within the domain. If the domain has a natural limit on this side (factor 1, lapse 0),
  /// the side is this limit.
  std::array<Interval, observer_key_count> ci95{};
  /// Inverse of the expected information, by ObserverKey, for ln parameter or the lapse; 0 for parameters that are not
  /// free. Empty if the information is singular, because the answers do not distinguish the parameters.
  std::optional<std::array<std::array<double, observer_key_count>, observer_key_count>> covariance;
  /// Whether each parameter is at a limit of its domain.
  std::array<bool, observer_key_count> at_limit{};
  double log_likelihood = 0;
  std::size_t answers = 0;
};

/// Returns the correlation of the estimates `a` and `b` (ObserverKey); empty without covariance or if one is not free.
[[nodiscard]] std::optional<double> correlation(const PersonFit& fit, std::size_t a, std::size_t b);
/// Returns the standard error of the logarithm of a parameter (for the lapse: of the lapse). Empty without a
/// covariance, or if the parameter is not free.
[[nodiscard]] std::optional<double> standard_error(const PersonFit& fit, std::size_t key);

/// Fits the parameters by maximum likelihood from several starting points. Errors: `invalid_input` (no answers, no free
/// parameter, a starting point outside the domain).
[[nodiscard]] Result<PersonFit> fit_person(AnswerLattice& lattice, std::span<const PersonAnswer> answers,
                                           const PersonFitOptions& options);

}  // namespace todbench
