// SPDX-License-Identifier: GPL-3.0-or-later
// Proportion correct of a simulated sensor as a function of size and contrast, interpolated between tables at a few
// contrasts.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "tod/psychometric/twin_shape.h"

namespace todbench {

/// Noise that determines how the function changes with the contrast.
struct ContrastNoise {
  double noise_k = 0;         ///< temporal noise of a pixel
  double internal_noise = 0;  ///< internal noise of the observer, relative to the contrast; 0: 0.07 as in hvs-1
};

/// Returns the coordinate u of a contrast dT: u = ln(hypot(noise_k / |dT|, n) / n) / ln 5, n: internal noise.
/// u is 0 if the internal noise of the observer dominates. u is 1 at about a fifth of the contrast at which internal
/// noise and sensor noise are equal. If the counts are fine enough, contrasts with the same u have the same function.
[[nodiscard]] double contrast_bend(const ContrastNoise& noise, double delta_t_k);
/// Returns contrasts, decreasing from `strongest_k` to `weakest_k`, at which tables describe the function. The steps
/// are at most 0.2 in u: ln_threshold() then agrees with a closed form within 0.1 %.
[[nodiscard]] std::vector<double> contrasts_of_surface(const ContrastNoise& noise, double strongest_k,
                                                       double weakest_k);

/// Table of one contrast.
struct TableAtContrast {
  double delta_t_k = 0;
  ProportionTable table;
};

/// Proportion correct as a function of size and contrast. Immutable, cheap to copy.
class ContrastSurface {
 public:
  /// Creates a surface from at least two contrasts of one sign and different u. Errors: `invalid_input`, those of
  /// TwinShape::of().
  [[nodiscard]] static Result<ContrastSurface> of(std::span<const TableAtContrast> tables, const ContrastNoise& noise);

  /// Returns ln of the size at 75 %. This value is cubic in u between the contrasts of the tables, and constant above
  /// the strongest contrast.
  [[nodiscard]] double ln_threshold(double delta_t_k) const;
  /// Returns the slope of ln_threshold() per unit of ln contrast, from contrasts 1 % above and below.
  [[nodiscard]] double slope(double delta_t_k) const;
  /// Returns the value at ln(size / mrad). The value is interpolated between the functions of the neighbouring tables,
  /// after both were shifted to the same threshold.
  [[nodiscard]] TwinShape::Value at(double ln_size, double delta_t_k) const;
  [[nodiscard]] const ContrastNoise& noise() const { return noise_; }
  /// Returns the standard error of ln_threshold(), from the nearest table.
  [[nodiscard]] double standard_error(double delta_t_k) const;

 private:
  struct Node {
    double u = 0, ln_threshold = 0, se = 0;
    TwinShape shape;
  };
  std::shared_ptr<const std::vector<Node>> nodes_;
  ContrastNoise noise_;
};

}  // namespace todbench
