// White noise as the templates of a bank see it, from few numbers: a factor of the matrix of their products.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "hvs/observer/template_bank.h"

namespace todbench {

/// Scores of white noise of sd 1 per sample are jointly normal, with the products of the templates as covariance.
/// Templates of one shape at neighbouring places are nearly alike, so that this matrix is one of a small rank: a
/// pivoted Cholesky decomposition (Harbrecht, Peters and Schneider 2012) ends when no template has more than
/// `max_left_out` of its variance left. Immutable, thread-safe.
///
/// Rows of scores here begin anew with each alternative: alternative o at place p is element o * row() + p.
class ScoreNoise {
 public:
  /// Variance of a score that may be missing, of 1. Scores of two small blurred triangles differ by little more than
  /// 1e-2 of their variance.
  static constexpr double max_left_out = 1e-5;

  explicit ScoreNoise(const TemplateBank& bank);

  /// Independent normal numbers that make one draw.
  [[nodiscard]] std::size_t rank() const { return rank_; }
  /// Places rounded up to whole blocks.
  [[nodiscard]] std::size_t row() const { return row_; }
  [[nodiscard]] std::size_t alternatives() const { return alternatives_; }
  /// row() times alternatives().
  [[nodiscard]] std::size_t size() const { return row_ * alternatives_; }

  /// Scores of a bank (padded_templates() elements) in rows: size() elements, `padding` where there is no place.
  void in_rows(std::span<const float> scores, float padding, std::span<float> rows) const;
  /// The factor of the templates from element `first` (a multiple of TemplateBank::block) on: rank() times
  /// TemplateBank::block values, number by number.
  [[nodiscard]] const float* factor(std::size_t first) const { return values_.data() + first * rank_; }
  /// The factor of one template: rank() numbers, of which the products with those of others are the covariances.
  void copy_factor(std::size_t index, std::span<float> numbers) const;
  /// What `numbers` are to all templates: size() scores.
  void scores(std::span<const float> numbers, std::span<float> out) const;

 private:
  std::size_t rank_ = 0, places_ = 0, row_ = 0, alternatives_ = 0;
  std::vector<float> values_;  ///< [block of templates][number][template in block]
};

}  // namespace todbench
