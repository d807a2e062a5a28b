// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/base/distributions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

namespace todbench::distribution {
namespace {

// Closed forms: t with one degree of freedom is Cauchy's law, chi-squared with two the exponential one; F with two
// above is elementary, and t squared with n degrees is F with 1 and n.
TEST(Distributions, EqualTheirClosedForms) {
  for (const double x : {0.3, 1.7, 6.0}) {
    EXPECT_NEAR(cdf(Normal(1, 2), x), std::erfc((1 - x) / 2 / std::numbers::sqrt2) / 2, 1e-15);
    EXPECT_NEAR(pdf(Normal(1, 2), x), std::exp(-(x - 1) * (x - 1) / 8) / std::sqrt(8 * std::numbers::pi), 1e-16);
    EXPECT_NEAR(cdf(StudentsT(1), x), 0.5 + std::atan(x) / std::numbers::pi, 1e-15);
    EXPECT_NEAR(cdf(complement(ChiSquared(2), x)), std::exp(-x / 2), 1e-15);
    EXPECT_NEAR(cdf(complement(FisherF(2, 7), x)), std::pow(1 + 2 * x / 7, -3.5), 1e-14);
    EXPECT_NEAR(cdf(complement(FisherF(1, 7), x * x)), 2 * cdf(complement(StudentsT(7), x)), 1e-14);
  }
}

TEST(Distributions, OfVeryManyObservationsStudentsTIsNormal) {
  for (const auto& many : {std::optional<double>(), std::optional(std::numeric_limits<double>::infinity())}) {
    EXPECT_EQ(tail_above(1.7, many), cdf(complement(Normal(), 1.7)));
    EXPECT_EQ(quantile_above(0.025, many), quantile(complement(Normal(), 0.025)));
  }
  EXPECT_EQ(tail_above(1.7, 3.5), cdf(complement(StudentsT(3.5), 1.7)));
  EXPECT_NEAR(quantile_above(0.025, 7), 2.364624, 1e-6);
}

template <class Law>
void expect_inverse(const Law& law) {
  for (const double p : {1e-12, 0.025, 0.6}) {
    EXPECT_NEAR(cdf(law, quantile(law, p)) / p, 1, 1e-10);
    EXPECT_NEAR(cdf(complement(law, quantile(complement(law, p)))) / p, 1, 1e-10);
  }
  EXPECT_THROW((void)quantile(law, 1.5), std::domain_error);
}

TEST(Distributions, QuantilesAreTheInverseOnEitherSideAndOfSmallProbabilities) {
  expect_inverse(Normal(3, 0.5));
  expect_inverse(StudentsT(6));
  expect_inverse(ChiSquared(11));
  expect_inverse(FisherF(4, 9));
  EXPECT_THROW((void)quantile(StudentsT(0), 0.975), std::domain_error);
}

}  // namespace
}  // namespace todbench::distribution
