// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/observer/score_noise.h"

#include <algorithm>
#include <cmath>

#include "hvs/observer/block_product.h"

namespace todbench {
namespace {

constexpr std::size_t score_block = TemplateBank::block;

/// Columns of the factor, one per normal number.
std::vector<std::vector<double>> cholesky_columns(const TemplateBank& bank) {
  const auto templates = static_cast<std::size_t>(bank.templates());
  const auto side = static_cast<std::size_t>(bank.window_samples());
  std::vector<double> left(templates, 1);  // templates have unit norm
  std::vector<std::vector<double>> columns;
  std::vector<float> pivot(side * side), products(bank.padded_templates());
  while (columns.size() < std::min(templates, side * side)) {
    const auto at = static_cast<std::size_t>(std::max_element(left.begin(), left.end()) - left.begin());
    if (left[at] <= ScoreNoise::max_left_out) break;
    bank.copy_template(at, pivot);
    bank.project(pivot, products);
    std::vector<double> column(products.begin(), products.begin() + static_cast<std::ptrdiff_t>(templates));
    for (const std::vector<double>& earlier : columns) {
      for (std::size_t t = 0; t < templates; ++t) column[t] -= earlier[t] * earlier[at];
    }
    const double root = std::sqrt(left[at]);
    for (std::size_t t = 0; t < templates; ++t) {
      column[t] /= root;
      left[t] -= column[t] * column[t];
    }
    left[at] = 0;
    columns.push_back(std::move(column));
  }
  return columns;
}

}  // namespace

ScoreNoise::ScoreNoise(const TemplateBank& bank)
    : places_(static_cast<std::size_t>(bank.places())),
      row_((places_ + score_block - 1) / score_block * score_block),
      alternatives_(static_cast<std::size_t>(bank.alternatives())) {
  const std::vector<std::vector<double>> columns = cholesky_columns(bank);
  rank_ = columns.size();
  values_.assign(size() * rank_, 0.0F);
  for (std::size_t k = 0; k < rank_; ++k) {
    for (std::size_t t = 0; t < alternatives_ * places_; ++t) {
      const std::size_t at = t / places_ * row_ + t % places_;
      values_[(at / score_block * rank_ + k) * score_block + at % score_block] = static_cast<float>(columns[k][t]);
    }
  }
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
