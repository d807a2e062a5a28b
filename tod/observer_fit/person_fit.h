// The parameters of the template observer that fit one person's answers best.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "acquisition/core/result.h"
#include "tod/observer_fit/observer_values.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

struct PersonFitOptions {
  ObserverValues start{0.6, 0.07, 1, 0};  ///< where the search begins, and what is not free stays
  std::array<bool, observer_key_count> free{};
  enum class Intervals {
    none,  ///< and a few steps from the start instead of several climbs: for answers whose maximum is near it
    profile,
  } intervals = Intervals::profile;
};

struct PersonFit {
  ObserverValues values{};  ///< by ObserverKey
  std::array<bool, observer_key_count> free{};
  /// 95 %, profile likelihood (drop of 3.84 in twice ln likelihood). An open side: the likelihood does not fall so far
  /// before the end of the domain. At a limit that nothing can be beyond (factor 1, lapse 0) the side is that limit.
  std::array<Interval, observer_key_count> ci95{};
  /// Inverse of the expected information for ln sigma, ln n, ln f and the lapse; 0 where not free. Nothing where it is
  /// singular: the answers do not tell the parameters apart.
  std::optional<std::array<std::array<double, observer_key_count>, observer_key_count>> covariance;
  /// At an end of the domain.
  std::array<bool, observer_key_count> at_limit{};
  double log_likelihood = 0;
  std::size_t answers = 0;
};

/// Correlation of two estimates; nothing where there is no covariance or one is not free.
[[nodiscard]] std::optional<double> correlation(const PersonFit& fit, std::size_t a, std::size_t b);
/// Standard error of ln of the value (of the lapse itself); nothing where there is none.
[[nodiscard]] std::optional<double> standard_error(const PersonFit& fit, std::size_t key);

/// Maximum likelihood from several starts. `invalid_input`: no answers, nothing free, a start out of the domain.
[[nodiscard]] Result<PersonFit> fit_person(AnswerLattice& lattice, std::span<const PersonAnswer> answers,
                                           const PersonFitOptions& options);

}  // namespace todbench
