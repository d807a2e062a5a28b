// SPDX-License-Identifier: GPL-3.0-or-later
// Tests of a fitted function against its own answers.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "tod/adequacy/dispersion.h"
#include "tod/adequacy/false_alarms.h"
#include "tod/psychometric/psychometric_search.h"

namespace todbench {

/// The tested direction of departure that exceeds its limit most, or comes nearest to it.
struct Departure {
  std::string towards;  ///< for a sentence: "towards the acuity form"
  double score = 0;     ///< in standard deviations
  double limit = 0;     ///< of this direction; one of the limits is exceeded by chance with the stated probability
};

/// Test of a free lapse against the lapse assumed by the fit.
struct LapseTest {
  double lapse = 0;      ///< the free lapse
  double statistic = 0;  ///< twice the gain of ln likelihood, over the variance inflation of the lapse's score
  double limit = 0;      ///< exceeded by chance with the stated probability
};

/// Result of test_model().
struct ModelTest {
  std::optional<Departure> departure;  ///< empty: too few sizes for any direction
  std::optional<LapseTest> lapse;      ///< empty: the fit has a free lapse, or the test is not possible
  Dispersions scatter;
};

/// Score tests (Cox and Hinkley 1974, 9.3) towards the other form (one-sided, half of the probability), and towards
/// another chance level and a bend (both two-sided); likelihood-ratio test towards a lapse; scatter of the remaining
/// residuals. In clustered data a score has the variance over clusters (Liang and Zeger 1986), at least that of
/// independent trials, and Student's t. `fit` is regular: ok or extrapolated. `free_fit`: fit of the same levels with a
/// free lapse.
[[nodiscard]] ModelTest test_model(std::span<const Level> levels, const PsychometricFit& fit,
                                   const std::optional<PsychometricFit>& free_fit, const FitOptions& options,
                                   const FalseAlarms& probability);

/// Whether a slope at the upper end of the domain is significant: few trials often form a perfect step by chance.
/// Compares twice the gain in ln likelihood of a slope at the end of the domain over one of half the size with the
/// limit for `probability`.
[[nodiscard]] bool asks_for_steeper(std::span<const Level> levels, const PsychometricFit& fit,
                                    const FitOptions& options, double probability);

}  // namespace todbench
