// What an error of a contrast does to the acuity at it.
#pragma once

#include <optional>
#include <vector>

#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Size of the contrast that the camera saw, or of the one that was set where none is known.
[[nodiscard]] double contrast_seen_k(const TodPoint& point);

/// Standard error of the effective contrast; nothing where it was measured once and nobody knows how it scatters.
[[nodiscard]] std::optional<double> contrast_se_k(const TodPoint& point);
/// Whether there is a contrast whose scatter nobody knows.
[[nodiscard]] bool has_contrast_measured_once(const TodCurve& curve);

/// Of TodPoint::delta_t_se_k; nothing where it is not said.
[[nodiscard]] std::optional<double> freedom_of_contrast(const TodPoint& point);

/// Slope of ln acuity over ln |effective contrast| at each point, its size: of S75^2 = A + B / C + D / C^2 through the
/// point and its neighbours of the same sign, the constant of resolution and what noise adds to it; of two points the
/// larger of A + B / C and A + D / C^2. 1, the slope of an acuity in proportion to the contrast, where no neighbour has
/// a threshold.
[[nodiscard]] std::vector<double> contrast_slopes(const TodCurve& curve);

/// What the scatter of the measurements of a contrast leaves open of the acuity at it.
struct ContrastScatter {
  double se_ln_acuity = 0;                     ///< 0 where nobody knows how it scatters
  double shared_se_ln_acuity = 0;              ///< the part of it that no scatter over set-ups shows
  std::optional<double> degrees_of_freedom{};  ///< nothing: not said
};
/// At each point: the standard error of the contrast by contrast_slopes().
[[nodiscard]] std::vector<ContrastScatter> contrast_scatter(const TodCurve& curve);

}  // namespace todbench
