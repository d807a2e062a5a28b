// SPDX-License-Identifier: GPL-3.0-or-later
// Tests of a fitted function against the answers to which it was fitted.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "tod/adequacy/dispersion.h"
#include "tod/adequacy/false_alarms.h"
#include "tod/psychometric/psychometric_search.h"

namespace todbench {

/// Result of the score test with the largest ratio of score to limit.
struct Departure {
  std::string towards;  ///< phrase for reports: "towards the acuity form"
  double score = 0;     ///< score in standard deviations
  /// Limit for this direction; the probability that any direction exceeds its limit by chance is
  /// FalseAlarms::departure.
  double limit = 0;
};

/// Test of a free lapse against the lapse assumed by the fit.
struct LapseTest {
  double lapse = 0;      ///< the free lapse
  double statistic = 0;  ///< twice the gain of ln likelihood, divided by the variance inflation of the lapse's score
  double limit = 0;      ///< the statistic exceeds it by chance with the probability FalseAlarms::lapse
};

/// Result of test_model().
struct ModelTest {
  std::optional<Departure> departure;  ///< empty: too few sizes for any direction
  std::optional<LapseTest> lapse;      ///< empty: the fit has a free lapse, or the test is not possible
  Dispersions scatter;
};

/// Tests a fitted function in three ways. Score tests (Cox and Hinkley 1974, 9.3) examine departures towards the other
/// form (one-sided, with half of the permitted probability), towards a different chance level, and towards a bend (both
/// two-sided). A likelihood-ratio test examines a free lapse. The third test examines the scatter of the remaining
/// residuals. For clustered data, the variance of a score is the variance over clusters (Liang and Zeger 1986), at
/// least the variance of independent trials. The limits are then those of Student's t. `free_fit`: fit of the same
/// levels with a free lapse. Precondition: the verdict of `fit` is ok or extrapolated.
[[nodiscard]] ModelTest test_model(std::span<const Level> levels, const PsychometricFit& fit,
                                   const std::optional<PsychometricFit>& free_fit, const FitOptions& options,
                                   const FalseAlarms& probability);

/// Returns whether a slope at the upper limit of its domain is significant. The test is needed because, with few
/// trials, the answers often form a perfect step by chance. Twice the gain in ln likelihood from half the largest slope
/// to the largest slope is compared with the limit for `probability`.
[[nodiscard]] bool asks_for_steeper(std::span<const Level> levels, const PsychometricFit& fit,
                                    const FitOptions& options, double probability);

}  // namespace todbench
