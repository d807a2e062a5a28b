// What several people have in common, and by how much they differ.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tod/observer_fit/person_fit.h"

namespace todbench {

/// One parameter over several people, by ln of its value (the lapse by itself).
struct PeopleSpread {
  int persons = 0;             ///< with a standard error; the others say nothing here
  std::optional<double> mean;  ///< as a value: of the logarithms the geometric mean; nothing below two persons
  Interval mean_ci95;          ///< Hartung and Knapp 2001, Student's t with persons - 1
  /// Standard deviation between people beyond the standard errors, of ln of the value (of the lapse itself), restricted
  /// maximum likelihood (Viechtbauer 2005).
  std::optional<double> between_sd;
  Interval between_sd_ci95;               ///< Q profile (Viechtbauer 2007); 0 where it reaches it
  std::optional<double> heterogeneity_p;  ///< of Cochran's Q: that all are the same
};

/// An estimate and its standard error.
struct PersonEstimate {
  double value = 0, se = 0;
};
/// Random effects over estimates; the sides of the result are not transformed.
[[nodiscard]] PeopleSpread spread_over(std::span<const PersonEstimate> estimates);
/// Of one parameter over people.
[[nodiscard]] PeopleSpread people_spread(std::span<const PersonFit> people, std::size_t key);

}  // namespace todbench
