// SPDX-License-Identifier: GPL-3.0-or-later
// Statistical distributions: the functions of Boost.Math, compiled in one source file because their templates take
// seconds to compile.
#pragma once

#include <optional>

namespace todbench::distribution {

/// The normal distribution.
struct Normal {
  explicit Normal(double m = 0, double s = 1) : mean(m), sd(s) {}
  double mean, sd;
};

/// Student's t.
struct StudentsT {
  explicit StudentsT(double freedom) : degrees_of_freedom(freedom) {}
  double degrees_of_freedom;
};

/// The chi-squared distribution.
struct ChiSquared {
  explicit ChiSquared(double freedom) : degrees_of_freedom(freedom) {}
  double degrees_of_freedom;
};

/// Fisher's F: the ratio of two mean squares.
struct FisherF {
  FisherF(double above, double below) : numerator_freedom(above), denominator_freedom(below) {}
  double numerator_freedom, denominator_freedom;
};

/// Selects the upper tail of a distribution, to avoid the cancellation in 1 - p.
template <class Law>
struct Complement {
  Law law;
  double value;  ///< value of the variable for cdf(), probability for quantile()
};
/// Returns a Complement.
template <class Law>
[[nodiscard]] Complement<Law> complement(const Law& law, double value) {
  return {law, value};
}

/// Return distribution function, quantile and density of the four distributions above. The functions throw
/// std::domain_error, as Boost.Math does, if degrees of freedom are not positive or a probability is outside 0..1.
template <class Law>
[[nodiscard]] double cdf(const Law& law, double x);
template <class Law>
[[nodiscard]] double cdf(const Complement<Law>& above);
template <class Law>
[[nodiscard]] double quantile(const Law& law, double probability);
template <class Law>
[[nodiscard]] double quantile(const Complement<Law>& above);
[[nodiscard]] double pdf(const Normal& law, double x);

/// Returns the probability above `x` of Student's t, or of the standard normal if the degrees of freedom are absent or
/// infinite.
[[nodiscard]] double tail_above(double x, const std::optional<double>& degrees_of_freedom);
/// Returns the value with `probability` above it: the inverse of tail_above().
[[nodiscard]] double quantile_above(double probability, const std::optional<double>& degrees_of_freedom);

}  // namespace todbench::distribution
