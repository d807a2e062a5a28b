// From the samples of an edge to its transfer function with intervals.
#pragma once

#include <vector>

#include "tod/measures/edge_line.h"

namespace todbench {

/// Over which part of the profile the derivative counts: fully up to `flat`, less and less up to `end` (a cosine).
struct EdgeWindow {
  double flat = 0, end = 0;  ///< pitches from the edge
  [[nodiscard]] double at(double t) const;
};

/// The sums of neighbouring rows, so that each group can be left out.
struct EdgeGroups {
  SplineSums all;
  std::vector<SplineSums> groups;
};
[[nodiscard]] EdgeGroups grouped(const std::vector<EdgeSample>& samples, const SplineGrid& grid, int rows);

struct EdgeTransfer {
  std::vector<double> mtf, low, high;
};
/// The modulus of the transform of the profile's derivative, 1 at frequency 0, corrected for what noise adds to a
/// modulus; 95 % intervals by leaving out one group after the other. `rounding` joins them: what counts that no noise
/// spreads do to the profile, as a share of the step, alike in all groups. Empty where a part cannot be fitted.
[[nodiscard]] EdgeTransfer edge_transfer(const EdgeGroups& groups, const EdgeWindow& window,
                                         const std::vector<double>& frequency_per_pitch, double rounding = 0);

}  // namespace todbench
