// SPDX-License-Identifier: GPL-3.0-or-later
// Variance inflation of the threshold due to trials with a common phase, frame or fixed pattern.
#pragma once

#include <span>

#include "tod/psychometric/psychometric_likelihood.h"

namespace todbench {

/// Effect of clusters on an interval.
struct ClusterEffect {
  double clusters = 0;   ///< G; 0: no level has a cluster, trials are independent
  double inflation = 1;  ///< inflation of the variance of ln threshold, >= 1
};

/// Computes the effect from the cluster-robust variance (Liang and Zeger 1986). The inflation is this variance divided
/// by the variance of the model. The cluster-robust variance is the inverse information times the sum over clusters of
/// squared scores times the inverse information, times G/(G-1). If only some levels have a cluster, each trial of the
/// other levels is a separate cluster. If the fit has no information (step, one-sided data), the design effect of the
/// counts about their level means (Rao and Scott 1992) is used.
[[nodiscard]] ClusterEffect cluster_effect(std::span<const Level> levels, const PooledCounts& counts,
                                           PsychometricForm form, const Maximum<3>& maximum,
                                           std::optional<double> se_t);

/// Effect of clusters on graded answers, with their dispersion.
struct GradedEffect {
  ClusterEffect clusters;  ///< effective number; the inflation may be below 1
  IntervalKind kind = IntervalKind::two_way;
  std::optional<double> dispersion;  ///< as in PsychometricFit::dispersion
};

/// Computes the effect from the variance over presentations and positions (clustered_variance.h). If the fit has no
/// information, or if there are too few presentations or positions, the smaller number of clusters and the inflation of
/// single answers are used.
[[nodiscard]] GradedEffect graded_effect(std::span<const GradedAnswer> answers, const PooledCounts& counts,
                                         PsychometricForm form, const Maximum<3>& maximum, std::optional<double> se_t);

/// Returns twice the decrease of the ln likelihood from its maximum to a two-sided confidence limit. Without clusters,
/// it is the quantile of chi-square with one degree of freedom. With clusters, it is the square of Student's t with G -
/// 1 degrees of freedom, times the inflation; infinite for one cluster. `confidence`: for example 0.95.
[[nodiscard]] double confidence_drop(const ClusterEffect& effect, double confidence);

}  // namespace todbench
