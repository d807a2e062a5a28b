// SPDX-License-Identifier: GPL-3.0-or-later
// Graded answers of a bench whose true function is no Weibull, and the table of its twin.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "acquisition/base/rng.h"
#include "tests/tod/psychometric/psychometric_support.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench::testing {

/// Half of the phases see a triangle well, half badly: the mean of two Weibull functions, 0.75 at `threshold`.
inline double true_proportion(double size, double threshold, double slope_ratio) {
  constexpr double apart = 0.22;
  // So that the mean is 0.75 at the threshold; found once by bisection.
  static const double centre = [] {
    double low = 0.5, high = 2;
    for (int step = 0; step < 100; ++step) {
      const double middle = (low + high) / 2;
      const double mean = (psychometric(PsychometricForm::size, 1, middle * std::exp(apart), 5, 0) +
                           psychometric(PsychometricForm::size, 1, middle * std::exp(-apart), 2.2, 0)) /
                          2;
      (mean > 0.75 ? low : high) = middle;
    }
    return low;
  }();
  const double x = std::pow(size / threshold, slope_ratio);
  return (psychometric(PsychometricForm::size, x, centre * std::exp(apart), 5, 0) +
          psychometric(PsychometricForm::size, x, centre * std::exp(-apart), 2.2, 0)) /
         2;
}

struct GradedBench {
  double threshold = 2;
  double slope_ratio = 1;
  double presentation_sd = 0;  ///< of the scatter that a presentation shares, in units of its widest
  double place_sd = 0;
  int presentations = 24, rows = 8, columns = 4;
};

/// Eight set-ups of three presentations, each of which shows `rows` sizes `columns` times. A probability is the true
/// proportion and a symmetric scatter about it, so wide that it stays between 0 and 1: the mean stays, whatever is
/// shared.
inline std::vector<GradedAnswer> graded_answers_of(const GradedBench& bench, std::uint64_t seed) {
  const RandomStream stream(seed, "graded bench");
  const std::vector<double> sizes = geometric(0.9, 4.4, bench.rows);
  std::vector<GradedAnswer> answers;
  const int places = bench.rows * bench.columns;
  for (int p = 0; p < bench.presentations; ++p) {
    const int set_up = p / 3;
    for (int place = 0; place < places; ++place) {
      const double size = sizes[static_cast<std::size_t>(place / bench.columns)];
      const double mu = true_proportion(size, bench.threshold, bench.slope_ratio);
      const double shared =
          bench.presentation_sd * static_cast<double>(stream.sub(1).normal(static_cast<std::uint64_t>(p))) +
          bench.place_sd *
              static_cast<double>(stream.sub(2).normal(static_cast<std::uint64_t>(set_up * places + place)));
      const double room = std::min(mu, 1 - mu);
      const double own = 2 * stream.sub(3).uniform(answers.size()) - 1;
      answers.push_back({.size = size,
                         .probability_correct = mu + room * std::clamp(0.7 * own + shared, -1.0, 1.0),
                         .presentation = p,
                         .place = set_up * places + place,
                         .set_up = set_up});
    }
  }
  return answers;
}

/// What a direct estimate of a sensor with this function would give, with errors of `error` drawn at each size.
inline ProportionTable table_of(const GradedBench& bench, double error, std::uint64_t seed) {
  const RandomStream stream(seed, "table");
  ProportionTable table;
  for (int k = 0; k < 36; ++k) {
    const double size = 0.55 * std::pow(1.08, k);
    const double p = true_proportion(size, bench.threshold, bench.slope_ratio);
    const double se = error * 2 * std::sqrt(std::max(0.0, p * (1 - p))) + 1e-6;
    table.size_mrad.push_back(size);
    table.proportion_correct.push_back(
        std::clamp(p + se * static_cast<double>(stream.normal(static_cast<std::uint64_t>(k))), 0.0, 1.0));
    table.standard_error.push_back(se);
  }
  return table;
}

}  // namespace todbench::testing
