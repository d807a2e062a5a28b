// SPDX-License-Identifier: GPL-3.0-or-later
// Mean and spread of the fitted parameters over several people.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tod/observer_fit/person_fit.h"

namespace todbench {

/// One parameter over several people, by ln of its value (the lapse itself).
struct PeopleSpread {
  int persons = 0;             ///< those with a standard error; others are ignored
  std::optional<double> mean;  ///< mean value, geometric if by logarithms; empty below two persons
  Interval mean_ci95;          ///< Hartung and Knapp 2001, Student's t with persons - 1
  /// Standard deviation between people in excess of the standard errors, of ln of the value (of the lapse itself), by
  /// restricted maximum likelihood (Viechtbauer 2005).
  std::optional<double> between_sd;
  Interval between_sd_ci95;               ///< Q profile (Viechtbauer 2007); 0 if it extends to 0
  std::optional<double> heterogeneity_p;  ///< p of Cochran's Q for equal values of all persons
};

/// An estimate and its standard error.
struct PersonEstimate {
  double value = 0, se = 0;
};
/// Random-effects estimate; the results are not transformed back.
[[nodiscard]] PeopleSpread spread_over(std::span<const PersonEstimate> estimates);
/// Spread of one parameter over people.
[[nodiscard]] PeopleSpread people_spread(std::span<const PersonFit> people, std::size_t key);

}  // namespace todbench
