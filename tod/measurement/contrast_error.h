// How well a contrast is known that was measured in several set-ups by several triangles.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tod/psychometric/tod_curve.h"
#include "tod/registration/registration.h"

namespace todbench {

/// A contrast as the camera saw it in one set-up.
struct ContrastMeasurement {
  double set_delta_t_k = 0;
  double delta_t_k = 0;                       ///< mean over the triangles
  std::vector<ReferenceTriangle> references;  ///< each with its contrast in kelvin
};

struct ContrastError {
  double standard_error_k = 0;
  double shared_k = 0;  ///< the part of it that no scatter over set-ups shows: what their places have in common
  double degrees_of_freedom = 1;
};

/// Standard error of the mean over measurements of one contrast. What the triangles of a set-up have in common and what
/// the detectors of a place in the picture do (fixed pattern) both stay in that mean: set-ups and places are clusters
/// both ways, V_set_up + V_place - V_triangle (Cameron, Gelbach and Miller 2011), not below that of either alone. Two
/// triangles are at one place where their centroids are nearer than half their size: mountings and plates that put
/// triangles before the same detectors have one error of them, not several. Nothing with fewer than two set-ups and
/// fewer than two places.
[[nodiscard]] std::optional<ContrastError> contrast_error(std::span<const ContrastMeasurement> measurements);

/// Gives the points of a curve the errors of their contrasts, where `measurements` say them.
void add_contrast_errors(TodCurve& curve, std::span<const ContrastMeasurement> measurements);

}  // namespace todbench
