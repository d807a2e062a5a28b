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

/// The tested direction of departure that exceeds its limit most, or that comes nearest to its limit.
struct Departure {
  std::string towards;  ///< text for a sentence: "towards the acuity form"
  double score = 0;     ///< in standard deviations
  double limit = 0;     ///< limit of this direction; chance exceeds one of the limits with the stated probability
};

/// Test of a free lapse against the lapse assumed by the fit.
struct LapseTest {
  double lapse = 0;      ///< the free lapse
  double statistic = 0;  ///< twice the gain of ln likelihood, divided by the variance inflation of the lapse's score
  double limit = 0;      ///< chance exceeds it with the stated probability
};

/// Result of test_model().
struct ModelTest {
  std::optional<Departure> departure;  ///< empty: too few sizes for any direction
  std::optional<LapseTest> lapse;      ///< empty: the fit has a free lapse, or the test is not possible
  Dispersions scatter;
};

/// Tests a fitted function. There are score tests (Cox and Hinkley 1974, 9.3) towards the other form (one-sided, half
/// of the probability), and towards another chance level and a bend (both two-sided); a likelihood-ratio test towards a
/// lapse; and a test of the scatter of the remaining residuals. In clustered data the variance of a score is the
/// variance over clusters (Liang and Zeger 1986), at least the variance of independent trials; Student's t applies.
/// `fit` is regular: ok or extrapolated. `free_fit`: fit of the same levels with a free lapse.
[[nodiscard]] ModelTest test_model(std::span<const Level> levels, const PsychometricFit& fit,
                                   const std::optional<PsychometricFit>& free_fit, const FitOptions& options,
                                   const FalseAlarms& probability);

/// Returns whether a slope at the upper end of the domain is significant; few trials often form a perfect step by
/// chance. Compares twice the gain in ln likelihood, of a slope at the end of the domain over half this slope, with the
/// limit for `probability`.
[[nodiscard]] bool asks_for_steeper(std::span<const Level> levels, const PsychometricFit& fit,
                                    const FitOptions& options, double probability);

}  // namespace todbench
