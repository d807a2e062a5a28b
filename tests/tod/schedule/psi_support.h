// SPDX-License-Identifier: GPL-3.0-or-later
// Runs of the Psi method on a simulated observer: how good its placement is, and whether the intervals hold.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/tod/comparison/planning_reference.h"
#include "tod/psychometric/psychometric_fit.h"
#include "tod/schedule/psi_placement.h"

namespace todbench::testing {

using test::least_se_ln_threshold;

struct PsiRunSettings {
  int trials = 160;
  double slope = 3.5;
  double ln_threshold_half_width = 0.3;  ///< the truth is uniform within this of the middle of the prior, in ln
};

/// Answers of an observer with a Weibull function and no lapse. The same run number gives the same answers.
struct PsiRun {
  double ln_threshold = 0;  ///< truth
  std::vector<Level> levels;
};
inline PsiRun psi_run(const PsiRunSettings& settings, std::uint64_t number) {
  const RandomStream stream = RandomStream(static_cast<std::uint64_t>(settings.trials), "psi.study").sub(number);
  PsiRun run;
  run.ln_threshold = settings.ln_threshold_half_width * (2 * stream.sub(0).uniform(0) - 1);
  PsiOptions options;
  options.first_size = 0.2;
  options.last_size = 5;
  PsiPlacement placement(options, stream.sub(1));
  for (int i = 0; i < settings.trials; ++i) {
    const double size = placement.next();
    const double right = psychometric(PsychometricForm::size, size, std::exp(run.ln_threshold), settings.slope, 0);
    const double correct = stream.sub(2).uniform(static_cast<std::uint64_t>(i)) < right ? 1 : 0;
    placement.observe(size, correct, 1);
    run.levels.push_back({size, correct, 1});
  }
  return run;
}

struct PsiStudy {
  int runs = 0;
  double bias = 0, sd = 0;            ///< of ln threshold
  double efficiency = 0;              ///< variance of the Cramer-Rao bound over that reached
  double profile = 0, posterior = 0;  ///< share of 95 % intervals with the truth inside
  double half_width = 0;              ///< mean of the posterior's, in ln
};
inline PsiStudy psi_study(const PsiRunSettings& settings, int runs) {
  PsiStudy study;
  double sum = 0, squares = 0;
  for (int r = 0; r < runs; ++r) {
    const PsiRun run = psi_run(settings, static_cast<std::uint64_t>(r));
    const auto fit = fit_psychometric(run.levels, {});
    if (!fit || !fit->threshold || !fit->posterior) continue;
    const double truth = std::exp(run.ln_threshold), error = std::log(*fit->threshold) - run.ln_threshold;
    ++study.runs;
    sum += error;
    squares += error * error;
    if ((!fit->ci95.low || *fit->ci95.low <= truth) && (!fit->ci95.high || *fit->ci95.high >= truth)) ++study.profile;
    if (fit->posterior->low <= truth && fit->posterior->high >= truth) ++study.posterior;
    study.half_width += std::log(fit->posterior->high / fit->posterior->low) / 2;
  }
  study.bias = sum / study.runs;
  study.sd = std::sqrt(squares / study.runs - study.bias * study.bias);
  study.efficiency = std::pow(least_se_ln_threshold(settings.trials, settings.slope) / study.sd, 2);
  study.profile /= study.runs;
  study.posterior /= study.runs;
  study.half_width /= study.runs;
  return study;
}

}  // namespace todbench::testing
