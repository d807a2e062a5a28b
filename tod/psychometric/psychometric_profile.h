// SPDX-License-Identifier: GPL-3.0-or-later
// Profile-likelihood limits of the threshold.
#pragma once

#include <optional>
#include <vector>

#include "tod/psychometric/psychometric_search.h"

namespace todbench {

/// Starting point and drops of a profile.
struct ProfileRequest {
  double start_t = 0;          ///< the maximum, or any place in the supremum region
  double supremum = 0;         ///< supremum of the log-likelihood
  std::optional<double> se_t;  ///< standard error of t, for the first steps
  LikelihoodLimits limits;     ///< determine in advance whether a side has a crossing
  double wide_drop = 0;        ///< 2 (supremum - profile) at the outer crossing
  double narrow_drop = 0;      ///< at the inner crossing, <= wide_drop
};

/// Crossings in t, nearest to the start on each side; empty if the likelihood never decreases that far.
struct ProfileCrossings {
  struct Side {
    std::optional<double> wide, narrow;
  };
  Side below, above;
  /// Point with a likelihood above ProfileRequest::supremum, if the profile contains one: maximise again from this
  /// point.
  std::optional<Maximum<3>> better;
};

/// Follows the profile likelihood from the start to its crossings on both sides.
[[nodiscard]] ProfileCrossings profile_crossings(const PooledCounts& counts, PsychometricForm form,
                                                 const ScanGrid& grid, std::optional<double> lapse,
                                                 const ProfileRequest& request);

}  // namespace todbench
