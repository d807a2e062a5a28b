// SPDX-License-Identifier: GPL-3.0-or-later
// Simulated observers for the tests of adequacy: right models and wrong ones.
#pragma once

#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tests/tod/psychometric/graded_support.h"
#include "tests/tod/psychometric/psychometric_support.h"
#include "tod/adequacy/adequacy.h"
#include "tod/psychometric/twin_shape.h"

namespace todbench::testing {

/// A way to ask and a way to answer. Threshold 1, shifted by up to 15 %, unknown to the experimenter.
struct AdequacyDesign {
  std::string name{};
  int sizes = 8;
  int trials_per_size = 80;  ///< in each cluster
  double first = 0.5, last = 2;
  double slope = 3.5;
  PsychometricForm fitted = PsychometricForm::size;
  std::optional<double> fitted_lapse = 0.0;
  PsychometricForm truth = PsychometricForm::size;
  double lapse = 0;
  int clusters = 0;           ///< 0: independent trials
  double cluster_sd = 0;      ///< of ln threshold between clusters
  double overdispersion = 1;  ///< of the counts at a size, beta-binomial
  int rows = 1;               ///< rows at each size
};

/// A beta variable of mean `p` and variance p (1 - p) rho, by sums of two gamma variables (Marsaglia and Tsang 2000).
inline double beta_draw(double p, double rho, const RandomStream& stream) {
  const double total = 1 / rho - 1;
  std::uint64_t at = 0;
  const auto gamma = [&](double shape) {
    const double boost = shape < 1 ? std::pow(stream.uniform(at++), 1 / shape) : 1;
    const double d = (shape < 1 ? shape + 1 : shape) - 1.0 / 3, c = 1 / std::sqrt(9 * d);
    for (;;) {
      const double x = stream.sub(7).normal(at++);
      const double v = std::pow(1 + c * x, 3);
      if (v > 0 && std::log(stream.uniform(at++)) < x * x / 2 + d - d * v + d * std::log(v)) return boost * d * v;
    }
  };
  const double a = gamma(p * total), b = gamma((1 - p) * total);
  return a / (a + b);
}

inline std::vector<Level> drawn(const AdequacyDesign& design, const RandomStream& stream) {
  const double centre = std::exp(0.15 * (2 * stream.uniform(0) - 1));
  std::vector<Level> levels;
  for (int c = 0; c < std::max(design.clusters, 1); ++c) {
    const RandomStream own = stream.sub(static_cast<std::uint64_t>(c + 1));
    const double threshold = centre * std::exp(design.cluster_sd * static_cast<double>(own.normal(0)));
    for (const double size : geometric(design.first, design.last, design.sizes)) {
      const double p = psychometric(design.truth, size, threshold, design.slope, design.lapse);
      for (int row = 0; row < design.rows; ++row) {
        const RandomStream answers = own.sub(levels.size() + 1);
        const double rho = (design.overdispersion - 1) / (design.trials_per_size - 1);
        const double share = rho > 0 ? beta_draw(p, rho, answers.sub(1)) : p;
        levels.push_back({size, binomial_draw(share, design.trials_per_size, answers),
                          static_cast<double>(design.trials_per_size), design.clusters > 0 ? c : -1});
      }
    }
  }
  return levels;
}

/// How often each kind of finding was made, and how often the threshold was called unfit.
struct FindingShares {
  std::map<FindingKind, double> found;
  double unfit = 0;
  double not_identified = 0;
};

inline FindingShares finding_shares(const AdequacyDesign& design, int replicates, std::uint64_t seed) {
  FindingShares shares;
  const FitOptions options{design.fitted, design.fitted_lapse, false};
  for (int r = 0; r < replicates; ++r) {
    const std::vector<Level> levels = drawn(design, RandomStream(seed, "adequacy").sub(static_cast<std::uint64_t>(r)));
    const auto fit = fit_psychometric(levels, options);
    if (!fit->threshold) shares.not_identified += 1.0 / replicates;
    const Adequacy found = adequacy(levels, *fit, options);
    for (const AdequacyFinding& finding : found.findings) shares.found[finding.kind] += 1.0 / replicates;
    if (!found.adequate()) shares.unfit += 1.0 / replicates;
  }
  return shares;
}

/// Designs in which the model is right.
inline std::vector<AdequacyDesign> right_designs() {
  const auto acuity = PsychometricForm::acuity;
  return {
      {.name = "640 single trials", .sizes = 640, .trials_per_size = 1},
      {.name = "160 single trials", .sizes = 160, .trials_per_size = 1},
      {.name = "20 x 1000", .sizes = 20, .trials_per_size = 1000},
      {.name = "20 x 1000 acuity", .sizes = 20, .trials_per_size = 1000, .fitted = acuity, .truth = acuity},
      {.name = "12 clusters", .sizes = 8, .trials_per_size = 4, .clusters = 12},
      {.name = "24 clusters sd 0.08", .sizes = 8, .trials_per_size = 4, .clusters = 24, .cluster_sd = 0.08},
      {.name = "48 clusters sd 0.08", .sizes = 8, .trials_per_size = 4, .clusters = 48, .cluster_sd = 0.08},
      {.name = "48 clusters sd 0.2", .sizes = 8, .trials_per_size = 4, .clusters = 48, .cluster_sd = 0.2},
      {.name = "96 clusters of 20, demo", .sizes = 20, .trials_per_size = 1, .clusters = 96, .cluster_sd = 0.05},
      {.name = "10 x 4", .sizes = 10, .trials_per_size = 4},
      {.name = "7 x 30", .sizes = 7, .trials_per_size = 30},
      {.name = "8 x 80", .sizes = 8, .trials_per_size = 80},
      {.name = "8 x 80 acuity", .fitted = acuity, .truth = acuity},
      {.name = "8 x 80 wide", .first = 0.25, .last = 4},
      {.name = "8 x 80 slope 2", .slope = 2},
      {.name = "8 x 80 slope 6", .slope = 6},
      {.name = "8 x 80 lapse 0.02 free", .fitted_lapse = std::nullopt, .lapse = 0.02},
      {.name = "8 x 80 lapse 0 free", .fitted_lapse = std::nullopt},
      {.name = "8 x 80 lapse 0.02 fixed", .fitted_lapse = 0.02, .lapse = 0.02},
      {.name = "20 x 96", .sizes = 20, .trials_per_size = 96},
      {.name = "8 x 80 in rows of 8", .trials_per_size = 8, .rows = 10},
  };
}

/// Right and wrong answers fitted with the function of the twin, 24 presentations of 32. `twist` is a part of
/// the answers at every other size that turns round, `lapse` one of all.
inline TodPoint point_by_twin(std::uint64_t seed, double lapse, double twist) {
  auto answers = graded_answers_of({}, seed);
  const RandomStream lots(seed, "lots");
  std::map<std::pair<double, int>, Level> rows;
  std::map<double, int> sizes;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const int number = sizes.emplace(answers[i].size, static_cast<int>(sizes.size())).first->second;
    const double share = (true_proportion(answers[i].size, 2, 1) - 0.25) / 0.75;
    double p = 0.25 + (0.75 - lapse) * share;
    p += (number % 2 == 0 ? twist : -twist) * share * (1 - share);
    answers[i].probability_correct = lots.uniform(i) < p ? 1 : 0;
    Level& row = rows[{answers[i].size, answers[i].presentation}];
    row.size = answers[i].size;
    row.cluster = answers[i].presentation;
    row.total += 1;
    row.correct += answers[i].probability_correct;
  }
  TodPoint point;
  for (const auto& [key, row] : rows) point.levels.push_back(row);
  const auto weibull = fit_psychometric(point.levels, {.with_posterior = false});
  point.fit = fit_twin_shape(answers, *weibull, table_of({}, 0.001, seed), {}).value();
  point.free_lapse_fit = twin_fit_with_free_lapse(answers, point.fit, PsychometricForm::size).value();
  return point;
}

}  // namespace todbench::testing
