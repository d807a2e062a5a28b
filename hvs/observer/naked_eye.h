// SPDX-License-Identifier: GPL-3.0-or-later
// Identification of a shape by the naked eye, without display and sensor. A Landolt ring or a triangle is shown at a
// known position in one of four orientations, and the observer states the orientation.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "hvs/eye/contrast_sensitivity.h"
#include "hvs/observer/known_position.h"
#include "hvs/shape/polygon.h"

namespace todbench {

/// Returns a Landolt ring with the gap at the right: width of gap and stroke 1, outer diameter 5, centre at the origin.
[[nodiscard]] Polygon landolt_ring();

/// A shape in four orientations, 90 degrees apart. The score of orientation i is <H F_i, c H F + z>. F_i is the
/// spectrum of the shape in orientation i, F that of the shown shape, H the filter of the eye (EyeFilter), c the
/// contrast and z the noise of hvs-2. Immutable, thread-safe.
class NakedEyeShape {
 public:
  /// Prepares a polygon of any size. In the other functions, the size of the shape is the square root of its area.
  explicit NakedEyeShape(const Polygon& shape);

  /// Returns G_00 .. G_03, the products <H F_0, H F_o> at contrast 1, for a shape of this size.
  [[nodiscard]] std::array<double, 4> products(const EyeFilter& eye, double size_deg) const;
  /// Returns the probability of a correct answer. `contrast`: luminance difference divided by the luminance to which
  /// the eye adapts, without sign. `contrast_noise`: kappa.
  [[nodiscard]] double probability_correct(const EyeFilter& eye, double contrast_noise, double contrast,
                                           double size_deg) const;
  /// Returns the size (square root of area) in degrees at which `share_correct` of the answers are correct. The share
  /// is 75 % for a TOD. For an acuity test it is 62.5 %, half way between chance and 100 %. Empty if the size is not
  /// between 0.001 and 3 degrees.
  [[nodiscard]] std::optional<double> threshold_deg(const EyeFilter& eye, double contrast_noise, double contrast,
                                                    double share_correct) const;
  /// Returns the contrast at which `share_correct` of the answers are correct for a shape of this size. Empty if the
  /// contrast is not between 1e-6 and 10.
  [[nodiscard]] std::optional<double> threshold_contrast(const EyeFilter& eye, double contrast_noise, double size_deg,
                                                         double share_correct) const;

 private:
  /// Integral of F_0 F_o* over all directions, for the shape of area 1, at the frequencies (i + 1/2) step.
  std::vector<std::array<double, 4>> around_;
  std::vector<QuadratureNode> rule_;
};

}  // namespace todbench
