// SPDX-License-Identifier: GPL-3.0-or-later
// Standard error of a contrast that was measured in several set-ups by several triangles.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "tod/psychometric/contrast_slope.h"
#include "tod/psychometric/tod_curve.h"
#include "tod/registration/registration.h"

namespace todbench {

/// Effective contrast of one set-up.
struct ContrastMeasurement {
  double set_delta_t_k = 0;
  double delta_t_k = 0;                       ///< mean over the triangles
  std::vector<ReferenceTriangle> references;  ///< each with its contrast in kelvin
};

/// Returns the index of the position of a triangle in `known`, and adds the triangle if its position is not known.
/// Triangles whose centroids are closer than half their size have the same position, because different mountings and
/// plates may image them onto the same detectors.
[[nodiscard]] std::size_t place_of(const ReferenceTriangle& triangle, std::vector<ReferenceTriangle>& known);

/// Returns the standard error of the mean over measurements of one contrast. Two kinds of errors do not cancel in this
/// mean: errors common to the triangles of a set-up, and errors of the detectors at one position in the picture (fixed
/// pattern). Set-ups and positions (place_of()) are therefore treated as two-way clusters. The variance is V_set_up +
/// V_place - V_triangle (Cameron, Gelbach and Miller 2011), at least V_set_up and at least V_place: the variances with
/// set-ups, positions and single triangles as clusters. Empty with fewer than two set-ups and fewer than two positions.
[[nodiscard]] std::optional<ContrastError> contrast_error(std::span<const ContrastMeasurement> measurements);

/// Returns contrast_error() for each set contrast, at least the error due to noise. Contrasts whose error cannot be
/// estimated are omitted.
[[nodiscard]] std::map<double, ContrastError> contrast_errors(std::span<const ContrastMeasurement> measurements);

/// Sets the standard errors of the contrasts in the points of a curve, if they can be estimated from `measurements`.
void add_contrast_errors(TodCurve& curve, std::span<const ContrastMeasurement> measurements);

}  // namespace todbench
