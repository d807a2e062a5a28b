// SPDX-License-Identifier: GPL-3.0-or-later
// Variance inflation of the threshold due to trials that share a phase, a frame or a fixed pattern.
#pragma once

#include <span>

#include "tod/psychometric/psychometric_likelihood.h"

namespace todbench {

/// Effect of clusters on an interval.
struct ClusterEffect {
  double clusters = 0;   ///< G; 0: no row has a cluster, trials are independent
  double inflation = 1;  ///< inflation of the variance of ln threshold, >= 1
};

/// Returns the effect from the cluster-robust variance (Liang and Zeger 1986): inverse information times the sum over
/// clusters of squared scores times inverse information, times G/(G-1), divided by the model variance. In a set with
/// clusters, each trial of a row without a cluster is its own cluster. If the fit has no information (step, one-sided
/// data), the design effect of the counts about their level means (Rao and Scott 1992) is used.
[[nodiscard]] ClusterEffect cluster_effect(std::span<const Level> levels, const PooledCounts& counts,
                                           PsychometricForm form, const Maximum<3>& maximum,
                                           std::optional<double> se_t);

/// Effect of clusters on graded answers, with their dispersion.
struct GradedEffect {
  ClusterEffect clusters;  ///< effective number; the inflation may be below 1
  IntervalKind kind = IntervalKind::two_way;
  std::optional<double> dispersion;  ///< as in PsychometricFit::dispersion
};

/// Computes the effect from the variance over presentations and places (clustered_variance.h). If the fit has no
/// information, or if there are too few clusters of either kind, it uses the smaller number of clusters and the
/// inflation of single answers.
[[nodiscard]] GradedEffect graded_effect(std::span<const GradedAnswer> answers, const PooledCounts& counts,
                                         PsychometricForm form, const Maximum<3>& maximum, std::optional<double> se_t);

/// Returns 2 (llmax - ll) at a two-sided confidence limit. It is chi-square with one degree of freedom. With clusters
/// it is the inflated square of Student's t with G - 1 degrees of freedom; infinite for one cluster. `confidence` e.g.
/// 0.95.
[[nodiscard]] double confidence_drop(const ClusterEffect& effect, double confidence);

}  // namespace todbench
