// SPDX-License-Identifier: GPL-3.0-or-later
// Proportion correct of a simulated sensor over size and contrast, from tables at a few contrasts.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "tod/psychometric/twin_shape.h"

namespace todbench {

/// Sources of noise that decide how the function changes with the contrast.
struct ContrastNoise {
  double noise_k = 0;         ///< temporal noise of a pixel
  double internal_noise = 0;  ///< of the observer, relative to the contrast; 0: 0.07 as in hvs-1
};

/// Position u of a contrast on the curve: u = ln(hypot(noise_k / |dT|, n) / n) / ln 5, n the internal noise. u is 0
/// where the observer's own noise dominates and 1 at about a fifth of the contrast at which both noises are equal. The
/// function of a sensor depends on the contrast through u alone, as long as the counts are fine enough.
[[nodiscard]] double contrast_bend(const ContrastNoise& noise, double delta_t_k);
/// Contrasts, decreasing, from `strongest_k` to `weakest_k`, at which tables describe the function: steps of at most
/// 0.1 in u.
[[nodiscard]] std::vector<double> contrasts_of_surface(const ContrastNoise& noise, double strongest_k,
                                                       double weakest_k);

/// Table of one contrast.
struct TableAtContrast {
  double delta_t_k = 0;
  ProportionTable table;
};

/// Proportion correct over size and contrast. Immutable, cheap to copy.
class ContrastSurface {
 public:
  /// Makes a surface from at least two contrasts of one sign and different u. Errors: `invalid_input`, those of
  /// TwinShape::of().
  [[nodiscard]] static Result<ContrastSurface> of(std::span<const TableAtContrast> tables, const ContrastNoise& noise);

  /// ln of the size at 75 %: cubic in u between the contrasts of the tables, constant beyond the strongest.
  [[nodiscard]] double ln_threshold(double delta_t_k) const;
  /// Change of ln_threshold() for a contrast that is 1 % stronger, per unit of ln contrast.
  [[nodiscard]] double slope(double delta_t_k) const;
  /// Value at ln(size / mrad), by the functions of the neighbouring tables, shifted to the same threshold.
  [[nodiscard]] TwinShape::Value at(double ln_size, double delta_t_k) const;
  [[nodiscard]] const ContrastNoise& noise() const { return noise_; }
  /// Standard error of ln_threshold() from that of the nearest table.
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
