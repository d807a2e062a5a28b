// SPDX-License-Identifier: GPL-3.0-or-later
// Profile-likelihood limits of the threshold.
#pragma once

#include <optional>
#include <vector>

#include "tod/psychometric/psychometric_search.h"

namespace todbench {

/// Starting point and drops of a profile.
struct ProfileRequest {
  double start_t = 0;          ///< threshold of the maximum, or any threshold in the region of the supremum
  double supremum = 0;         ///< supremum of the log-likelihood
  std::optional<double> se_t;  ///< standard error of t, for the first steps
  /// Limits of the likelihood, from which it is known in advance whether there is a crossing on a side.
  LikelihoodLimits limits;
  double wide_drop = 0;    ///< 2 (supremum - profile) at the outer crossing
  double narrow_drop = 0;  ///< 2 (supremum - profile) at the inner crossing, <= wide_drop
};

/// Crossings in t = ln(threshold / reference size) that are nearest to the start on each side. A crossing is empty if
/// the likelihood never decreases by the drop.
struct ProfileCrossings {
  struct Side {
    std::optional<double> wide, narrow;
  };
  Side below, above;
  /// Point with a likelihood above ProfileRequest::supremum, if the profile contains such a point. Maximise again from
  /// this point.
  std::optional<Maximum<3>> better;
};

/// Follows the profile likelihood from the start to its crossings on both sides.
[[nodiscard]] ProfileCrossings profile_crossings(const PooledCounts& counts, PsychometricForm form,
                                                 const ScanGrid& grid, std::optional<double> lapse,
                                                 const ProfileRequest& request);

}  // namespace todbench
