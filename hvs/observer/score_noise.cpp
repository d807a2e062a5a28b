// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/observer/score_noise.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "hvs/observer/block_product.h"
#include "hvs/observer/eye_noise.h"
#include "hvs/observer/pivoted_cholesky.h"

namespace todbench {
namespace {

constexpr std::size_t score_block = TemplateBank::block;

/// Columns of the factor of white noise, one per normal number.
std::vector<std::vector<double>> white_columns(const TemplateBank& bank, double max_left_out) {
  const auto templates = static_cast<std::size_t>(bank.templates());
  const auto side = static_cast<std::size_t>(bank.window_samples());
  std::vector<float> pivot(side * side), products(bank.padded_templates());
  std::vector<double> variances(templates, 1);  // templates have unit norm
  if (bank.eye() != nullptr) {
    for (std::size_t t = 0; t < templates; ++t) variances[t] = bank.square(t);
  }
  return pivoted_cholesky(std::move(variances), max_left_out, side * side, [&](std::size_t at) {
    bank.copy_template(at, pivot);
    bank.project(pivot, products);
    return std::vector<double>(products.begin(), products.begin() + static_cast<std::ptrdiff_t>(templates));
  });
}

}  // namespace

ScoreNoise::ScoreNoise(const TemplateBank& bank, AddedWhiteNoise white)
    : places_(static_cast<std::size_t>(bank.places())),
      row_((places_ + score_block - 1) / score_block * score_block),
      alternatives_(static_cast<std::size_t>(bank.alternatives())) {
  std::vector<std::vector<double>> columns;
  if (bank.eye() != nullptr) columns = bank.eye()->columns();
  eye_rank_ = columns.size();
  if (white == AddedWhiteNoise::yes) {
    auto added = white_columns(bank, bank.eye() != nullptr ? EyeNoise::max_left_out : max_left_out);
    std::move(added.begin(), added.end(), std::back_inserter(columns));
  }
  rank_ = columns.size();
  values_.assign(size() * rank_, 0.0F);
  for (std::size_t k = 0; k < rank_; ++k) {
    for (std::size_t t = 0; t < alternatives_ * places_; ++t) {
      const std::size_t at = t / places_ * row_ + t % places_;
      values_[(at / score_block * rank_ + k) * score_block + at % score_block] = static_cast<float>(columns[k][t]);
    }
  }
  if (eye_rank_ == 0) return;
  squares_.assign(size(), 0.0F);
  for (std::size_t t = 0; t < alternatives_ * places_; ++t)
    squares_[t / places_ * row_ + t % places_] = static_cast<float>(bank.square(t));
}

void ScoreNoise::weigh(const ScoreNoiseLevels& levels, std::span<float> numbers) const {
  if (eye_rank_ == 0) return;
  const double total = levels.total();
  const auto eye = static_cast<float>(levels.eye / total), white = static_cast<float>(levels.white / total);
  for (std::size_t k = 0; k < rank_; ++k) numbers[k] *= k < eye_rank_ ? eye : white;
}

ScoreNoise::Shares ScoreNoise::shares(const ScoreNoiseLevels& levels) const {
  const double total = levels.total();
  if (eye_rank_ == 0 || total == 0) return {};
  return {static_cast<float>(std::pow(levels.eye / total, 2)), static_cast<float>(std::pow(levels.white / total, 2))};
}

void ScoreNoise::in_rows(std::span<const float> scores, float padding, std::span<float> rows) const {
  CV_Assert(rows.size() == size() && scores.size() >= alternatives_ * places_);
  for (std::size_t o = 0; o < alternatives_; ++o) {
    const auto mine = rows.subspan(o * row_, row_);
    std::copy_n(scores.begin() + static_cast<std::ptrdiff_t>(o * places_), places_, mine.begin());
    std::fill(mine.begin() + static_cast<std::ptrdiff_t>(places_), mine.end(), padding);
  }
}

void ScoreNoise::copy_factor(std::size_t index, std::span<float> numbers) const {
  CV_Assert(numbers.size() == rank_ && index < size());
  const float* own = factor(index / score_block * score_block) + index % score_block;
  for (std::size_t k = 0; k < rank_; ++k) numbers[k] = own[k * score_block];
}

void ScoreNoise::scores(std::span<const float> numbers, std::span<float> out) const {
  CV_Assert(numbers.size() == rank_ && out.size() == size());
  for (std::size_t first = 0; first < size(); first += score_block)
    block_product(factor(first), numbers.data(), rank_, &out[first]);
}

}  // namespace todbench
