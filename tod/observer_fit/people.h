// SPDX-License-Identifier: GPL-3.0-or-later
// Mean and spread of the fitted parameters among several people.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tod/observer_fit/person_fit.h"

namespace todbench {

/// One parameter among several people. Statistics are those of the logarithm of the parameter; the lapse is not
/// transformed.
struct PeopleSpread {
  int persons = 0;             ///< number of persons with a standard error; other persons are ignored
  std::optional<double> mean;  ///< mean value (for logarithms: geometric mean); empty for fewer than two persons
  Interval mean_ci95;          ///< after Hartung and Knapp (2001): Student's t with persons - 1 degrees of freedom
  /// Standard deviation between people of the logarithm of the parameter (for the lapse: of the lapse), without the
  /// contribution of the standard errors. Computed by restricted maximum likelihood (Viechtbauer 2005).
  std::optional<double> between_sd;
  Interval between_sd_ci95;               ///< Q profile method (Viechtbauer 2007); the lower limit may be 0
  std::optional<double> heterogeneity_p;  ///< p value of Cochran's Q test for equal values of all persons
};

/// An estimate and its standard error.
struct PersonEstimate {
  double value = 0, se = 0;
};
/// Returns the random-effects estimate. Neither the values nor the results are transformed.
[[nodiscard]] PeopleSpread spread_over(std::span<const PersonEstimate> estimates);
/// Returns the spread of one parameter among people. `key`: ObserverKey as an index.
[[nodiscard]] PeopleSpread people_spread(std::span<const PersonFit> people, std::size_t key);

}  // namespace todbench
