// SPDX-License-Identifier: GPL-3.0-or-later
// How often the interval of a simulated experiment contains the truth.
#pragma once

#include <cmath>
#include <vector>

#include "tests/tod/psychometric/psychometric_support.h"

namespace todbench::testing {

/// Constant stimuli about a threshold of 1 at slope 3.5 and lapse 0; the sizes are shifted by up to +-15 %, unknown to
/// the experimenter.
struct Design {
  int sizes = 10;
  int trials_per_size = 16;
  double span = 4;  ///< largest over smallest size
};

struct Coverage {
  double profile = 0, posterior = 0;
};

inline bool contains(const Interval& interval, double value) {
  return (!interval.low || *interval.low <= value) && (!interval.high || *interval.high >= value);
}

enum class Posteriors { skip, count };

inline Coverage coverage(const Design& design, int replicates, Posteriors posteriors, std::uint64_t seed) {
  Coverage hits;
  for (int r = 0; r < replicates; ++r) {
    const RandomStream stream = RandomStream(seed, "coverage").sub(static_cast<std::uint64_t>(r));
    const double centre = std::exp(0.15 * (2 * stream.uniform(0) - 1));
    std::vector<Level> levels;
    for (const double size :
         geometric(centre / std::sqrt(design.span), centre * std::sqrt(design.span), design.sizes)) {
      const double p = psychometric(PsychometricForm::size, size, 1, 3.5, 0);
      levels.push_back({size, binomial_draw(p, design.trials_per_size, stream.sub(levels.size() + 1)),
                        static_cast<double>(design.trials_per_size), -1});
    }
    const auto fit = fit_psychometric(levels, {.with_posterior = posteriors == Posteriors::count});
    if (contains(fit->ci95, 1)) hits.profile += 1.0 / replicates;
    if (fit->posterior && fit->posterior->low <= 1 && fit->posterior->high >= 1) hits.posterior += 1.0 / replicates;
  }
  return hits;
}

/// An experiment whose clusters (presentations) each see every size; a cluster shifts ln threshold by a normal amount.
struct ClusteredDesign {
  int clusters = 24;
  int sizes = 8;
  int trials_per_size = 4;  ///< in each cluster
  double cluster_sd = 0.15;
};

inline std::vector<Level> clustered_data(const ClusteredDesign& design, const RandomStream& stream) {
  std::vector<Level> levels;
  for (int c = 0; c < design.clusters; ++c) {
    const RandomStream own = stream.sub(static_cast<std::uint64_t>(c));
    const double threshold = std::exp(design.cluster_sd * static_cast<double>(own.normal(0)));
    for (const double size : geometric(0.6, 1.6, design.sizes)) {
      const double p = psychometric(PsychometricForm::size, size, threshold, 4, 0);
      const RandomStream answers = own.sub(levels.size() + 1);
      levels.push_back(
          {size, binomial_draw(p, design.trials_per_size, answers), static_cast<double>(design.trials_per_size), c});
    }
  }
  return levels;
}

/// The threshold that infinitely many clusters lead to: the fit of the psychometric function averaged over the cluster
/// effect (midpoint rule over +-6 standard deviations), which is not a Weibull function.
inline double marginal_threshold(const ClusteredDesign& design) {
  std::vector<Level> levels;
  for (const double size : geometric(0.6, 1.6, design.sizes)) {
    double mean = 0, weight = 0;
    for (int i = 0; i < 240; ++i) {
      const double z = -6 + 12 * (i + 0.5) / 240, w = std::exp(-z * z / 2);
      mean += w * psychometric(PsychometricForm::size, size, std::exp(design.cluster_sd * z), 4, 0);
      weight += w;
    }
    levels.push_back({size, std::round(1e9 * mean / weight), 1e9, -1});
  }
  return fit_psychometric(levels, {.with_posterior = false})->threshold.value();
}

struct ClusteredCoverage {
  double clustered = 0;  ///< of the interval with clusters named
  double naive = 0;      ///< of the interval that takes trials as independent
  double mean_inflation = 0;
};

inline ClusteredCoverage clustered_coverage(const ClusteredDesign& design, int replicates, std::uint64_t seed) {
  const double truth = marginal_threshold(design);
  ClusteredCoverage result;
  for (int r = 0; r < replicates; ++r) {
    std::vector<Level> levels =
        clustered_data(design, RandomStream(seed, "clusters").sub(static_cast<std::uint64_t>(r)));
    const auto clustered = fit_psychometric(levels, {.with_posterior = false});
    for (Level& level : levels) level.cluster = -1;
    const auto naive = fit_psychometric(levels, {.with_posterior = false});
    if (contains(clustered->ci95, truth)) result.clustered += 1.0 / replicates;
    if (contains(naive->ci95, truth)) result.naive += 1.0 / replicates;
    result.mean_inflation += clustered->variance_inflation / replicates;
  }
  return result;
}

/// Standard error of a share `p` estimated from `n` replicates.
inline double share_error(double p, int n) {
  return std::sqrt(p * (1 - p) / n);
}

}  // namespace todbench::testing
