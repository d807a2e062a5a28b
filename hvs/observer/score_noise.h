// SPDX-License-Identifier: GPL-3.0-or-later
// Template scores of white noise, computed from few random numbers and a factor of the matrix of template products.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "hvs/observer/template_bank.h"

namespace todbench {

/// Standard deviations of the noise that an observer adds, in units of the signal.
struct ScoreNoiseLevels {
  double white = 0;  ///< white noise per sample
  double eye = 0;    ///< noise of the eye in a score (EyeNoise::sd())
  [[nodiscard]] double total() const { return eye == 0 ? white : std::hypot(white, eye); }
};

/// Whether an observer adds white noise to the samples.
enum class AddedWhiteNoise { no, yes };

/// Factor of the covariance of template scores. The scores of white noise with sd 1 per sample are jointly normal, and
/// their covariance is the matrix of template products. Templates of one shape at neighbouring positions are nearly
/// equal, so this matrix has a low effective rank. A pivoted Cholesky decomposition (Harbrecht, Peters and Schneider
/// 2012) ends when at most `max_left_out` of the variance of every template remains. Immutable, thread-safe.
///
/// With an eye, the random numbers of the eye's noise are first, followed by those of the white noise. weigh() scales
/// both to their shares of the total.
///
/// Each alternative begins a new row of scores: alternative o at search position p is element o * row() + p.
class ScoreNoise {
 public:
  /// Largest share of the variance of a score that may be missing. For comparison, the scores of two small blurred
  /// triangles differ by slightly more than 1e-2 of their variance.
  static constexpr double max_left_out = 1e-5;

  explicit ScoreNoise(const TemplateBank& bank, AddedWhiteNoise white = AddedWhiteNoise::yes);

  /// Returns the number of independent normal numbers in one draw.
  [[nodiscard]] std::size_t rank() const { return rank_; }
  /// Returns the number of search positions, rounded up to whole blocks.
  [[nodiscard]] std::size_t row() const { return row_; }
  [[nodiscard]] std::size_t alternatives() const { return alternatives_; }
  /// Returns row() times alternatives().
  [[nodiscard]] std::size_t size() const { return row_ * alternatives_; }

  /// Rearranges scores of a bank (padded_templates() elements) into rows of size() elements in total. Unused elements
  /// are set to `padding`.
  void in_rows(std::span<const float> scores, float padding, std::span<float> rows) const;
  /// Returns the factor of the templates from element `first` (a multiple of TemplateBank::block): rank() times
  /// TemplateBank::block values, ordered by random number.
  [[nodiscard]] const float* factor(std::size_t first) const { return values_.data() + first * rank_; }
  /// Copies the factor of one template: rank() numbers. The scalar product of the factors of two templates is the
  /// covariance of their scores.
  void copy_factor(std::size_t index, std::span<float> numbers) const;
  /// Multiplies numbers by the shares of eye and white noise in the total. No effect without an eye.
  void weigh(const ScoreNoiseLevels& levels, std::span<float> numbers) const;
  /// Shares of eye and white noise in the variance of the noise, if this variance is scaled to 1.
  struct Shares {
    float eye = 1, white = 0;
  };
  [[nodiscard]] Shares shares(const ScoreNoiseLevels& levels) const;
  /// Returns the variance of a score for noise of variance 1; without an eye, the result is 1.
  [[nodiscard]] float variance(const Shares& shares, std::size_t index) const {
    return squares_.empty() ? 1 : shares.eye + shares.white * squares_[index];
  }
  /// Computes the scores of all templates for the normal numbers `numbers`: size() elements.
  void scores(std::span<const float> numbers, std::span<float> out) const;

 private:
  std::size_t rank_ = 0, eye_rank_ = 0, places_ = 0, row_ = 0, alternatives_ = 0;
  std::vector<float> values_;   ///< [block of templates][number][template in block]
  std::vector<float> squares_;  ///< squared norm of each template; only with an eye
};

}  // namespace todbench
