// SPDX-License-Identifier: GPL-3.0-or-later
// Mean and spread of the fitted parameters among several people.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tod/observer_fit/person_fit.h"

namespace todbench {

/// One parameter among several people, in terms of ln of its value (the lapse itself).
struct PeopleSpread {
  int persons = 0;             ///< number of persons with a standard error; others are ignored
  std::optional<double> mean;  ///< mean value, geometric if in logarithms; empty for fewer than two persons
  Interval mean_ci95;          ///< Hartung and Knapp 2001, Student's t with persons - 1
  /// Standard deviation between people in excess of the standard errors, of ln of the value (of the lapse itself).
  /// Computed by restricted maximum likelihood (Viechtbauer 2005).
  std::optional<double> between_sd;
  Interval between_sd_ci95;               ///< Q profile (Viechtbauer 2007); the lower end is 0 if it extends to 0
  std::optional<double> heterogeneity_p;  ///< p of Cochran's Q for equal values of all persons
};

/// An estimate and its standard error.
struct PersonEstimate {
  double value = 0, se = 0;
};
/// Returns the random-effects estimate; the results are not transformed back.
[[nodiscard]] PeopleSpread spread_over(std::span<const PersonEstimate> estimates);
/// Returns the spread of one parameter among people.
[[nodiscard]] PeopleSpread people_spread(std::span<const PersonFit> people, std::size_t key);

}  // namespace todbench
