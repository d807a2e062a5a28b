// SPDX-License-Identifier: GPL-3.0-or-later
// Noise of the eye in the scores of an observer's templates.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "hvs/eye/viewed_display.h"
#include "hvs/observer/observer.h"
#include "hvs/shape/polygon_image.h"

namespace todbench {

/// Templates of an observer with an eye, as continuous patterns.
struct EyeTemplates {
  Alternatives shapes{};      ///< alternatives at the target's size, in displayed samples
  int steps = 8;              ///< search positions per sample
  int reach = 8;              ///< search steps in each direction
  double sample_deg = 0;      ///< side of a displayed sample
  double contrast_noise = 0;  ///< kappa of EyeParameters
  double template_scale = 1;  ///< d'^2 at contrast 1 per unit of the bank's scores
  ViewedDisplay display;
};

/// White noise of 1 per square degree after the eye's filter H. The scores of templates i and j have the covariance
/// G_ij = <H F_i, H F_j>, where F is the spectrum of the target after the display. G_ii is d'^2 of the ideal target at
/// contrast 1. At luminance contrast c, noise proportional to the contrast multiplies the standard deviation by sqrt(1
/// + kappa^2 c^2 G_ii), kappa = contrast_noise. Immutable, thread-safe.
class EyeNoise {
 public:
  /// Largest share of the variance of a score that may be missing in the draws. For comparison: the difference between
  /// the scores of two small triangles has about 1e-2 of the variance of one score.
  static constexpr double max_left_out = 3e-4;

  /// `power`: H^2 times the square of the display's transfer; its frequencies are in cycles per displayed sample.
  EyeNoise(EyeTemplates templates, const FilterTable& power);

  /// Returns G of two templates. Indices as in the bank.
  [[nodiscard]] double covariance(std::size_t first, std::size_t second) const;
  /// Returns d'^2 of the ideal target at luminance contrast 1.
  [[nodiscard]] double energy() const { return energy_; }
  /// Returns the standard deviation of the noise in a score of the bank for a target of `contrast_k`, in units of the
  /// contrast.
  [[nodiscard]] double sd(double contrast_k) const;
  /// Returns the same standard deviation for an eye with `gain` times the sensitivity and with kappa =
  /// `contrast_noise`.
  [[nodiscard]] double sd(double contrast_k, double gain, double contrast_noise) const;
  /// Returns the number of independent normal numbers in one draw.
  [[nodiscard]] std::size_t rank() const { return columns_.size(); }
  /// Returns the columns of the covariance factor, relative to energy(). A column has one value for each template.
  [[nodiscard]] const std::vector<std::vector<double>>& columns() const { return columns_; }
  /// Adds `sd` times the noise scores that belong to the normal numbers. `numbers`: rank() elements; `scores`:
  /// padded_templates() elements.
  void add(std::span<const float> numbers, float sd, std::span<float> scores) const;

 private:
  void tabulate(const FilterTable& power);
  [[nodiscard]] bool shapes_are_turned() const;
  void decompose();
  [[nodiscard]] std::size_t alternatives() const { return templates_.shapes.size(); }
  [[nodiscard]] int places() const { return (2 * templates_.reach + 1) * (2 * templates_.reach + 1); }

  EyeTemplates templates_;
  double energy_ = 0;
  /// True if alternative o is alternative 0 after o quarter turns, and the filter has the same symmetry. Four tables
  /// are then sufficient.
  bool turned_ = false;
  std::vector<std::vector<double>> tables_;  ///< G for each pair of alternatives, as a function of the displacement
  std::vector<std::vector<double>> columns_;
  std::vector<float> factor_;  ///< [block of templates][number][template in block]
};

}  // namespace todbench
