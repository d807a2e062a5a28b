// Tests of a fitted function against its own answers.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "tod/adequacy/dispersion.h"
#include "tod/adequacy/false_alarms.h"
#include "tod/psychometric/psychometric_search.h"

namespace todbench {

/// The departure in one of the stated directions that exceeds its limit most, or comes nearest to it.
struct Departure {
  std::string towards;  ///< in a sentence: "towards the acuity form"
  double score = 0;     ///< in standard deviations
  double limit = 0;     ///< of this direction; chance exceeds one of the limits with the stated probability
};

/// A free lapse against the one that the fit assumes.
struct LapseTest {
  double lapse = 0;      ///< the free one
  double statistic = 0;  ///< twice the gain of ln likelihood, over the variance inflation of the lapse's score
  double limit = 0;      ///< that chance exceeds with the stated probability
};

struct ModelTest {
  std::optional<Departure> departure;  ///< nothing: too few sizes for any direction
  std::optional<LapseTest> lapse;      ///< nothing: the fit has a free one, or the test is not possible
  Dispersions scatter;
};

/// Score tests (Cox and Hinkley 1974, 9.3) towards the other form (one-sided, half of the probability), another chance
/// level and a bend (both two-sided); towards a lapse by likelihood ratio; the scatter of what is left. In clustered
/// data a score has the variance of clusters (Liang and Zeger 1986), at least that of independent trials, and Student's
/// t. `fit` is regular: ok or extrapolated. `free_fit`: of the same levels with a free lapse.
[[nodiscard]] ModelTest test_model(std::span<const Level> levels, const PsychometricFit& fit,
                                   const std::optional<PsychometricFit>& free_fit, const FitOptions& options,
                                   const FalseAlarms& probability);

/// Whether a slope at the upper end of the domain is more than a fluke: answers of few trials are often in a perfect
/// step. Twice the ln likelihood by which the end is better than half of it, as above.
[[nodiscard]] bool asks_for_steeper(std::span<const Level> levels, const PsychometricFit& fit,
                                    const FitOptions& options, double probability);

}  // namespace todbench
