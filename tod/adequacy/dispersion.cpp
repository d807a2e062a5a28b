// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/adequacy/dispersion.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "acquisition/base/distributions.h"

namespace todbench {
namespace {

// A sum of squares with its mean and variance under the model.
struct SumOfSquares {
  double value = 0, mean = 0, variance = 0;
};

// Groups neighbouring levels until each group has this variance of its number of right answers.
std::vector<std::vector<double>> groups_of(const ModelResiduals& model) {
  constexpr double least_variance = 4;  // about five expected answers of the rarer kind
  constexpr double most_groups = 40;    // with more, single groups carry no information
  double whole = 0;
  for (const LevelResidual& level : model.levels) whole += level.variance();
  const double enough = std::max(least_variance, whole / most_groups);
  std::vector<std::vector<double>> groups;
  double collected = enough;
  for (std::size_t i = 0; i < model.levels.size(); ++i) {
    const LevelResidual& level = model.levels[i];
    if (collected >= enough || level.catch_trials) {
      groups.emplace_back(model.levels.size(), 0.0);
      collected = 0;
    }
    groups.back()[i] = 1;
    collected += level.variance();
  }
  // The remainder joins its neighbour.
  if (groups.size() > 1 && collected < enough && !model.levels.back().catch_trials) {
    for (std::size_t i = 0; i < model.levels.size(); ++i) groups[groups.size() - 2][i] += groups.back()[i];
    groups.pop_back();
  }
  return groups;
}

std::vector<Direction> orthogonal_groups(const ModelResiduals& model, std::span<const Direction> besides) {
  const Directions make(model);
  std::vector<Direction> all(besides.begin(), besides.end());
  const std::size_t first = all.size();
  for (std::vector<double>& group : groups_of(model)) {
    // The last groups are reduced to almost zero by the parameters and earlier groups.
    if (auto direction = make.direction(std::move(group), all)) all.push_back(*std::move(direction));
  }
  return {all.begin() + static_cast<std::ptrdiff_t>(first), all.end()};
}

// Pearson's statistic of a table of rows by right and wrong with all margins given: mean and variance are exact.
SumOfSquares within_one_size(std::span<const Level* const> rows) {
  double right = 0, n = 0, reciprocals = 0;
  for (const Level* row : rows) {
    right += row->correct;
    n += row->total;
    reciprocals += 1 / row->total;
  }
  const double wrong = n - right, r = static_cast<double>(rows.size());
  if (rows.size() < 2 || right <= 0 || wrong <= 0 || n < 4) return {};
  SumOfSquares sum;
  const double p = right / n;
  for (const Level* row : rows) sum.value += std::pow(row->correct - row->total * p, 2) / (row->total * p * (1 - p));
  // Dawson 1954, "A simplified expression for the variance of the chi-square function on a contingency table".
  const double v_rows = (r - 1) * (n - r) / (n - 1), w_rows = (n * reciprocals - r * r) / (n - 2);
  const double v_columns = (n - 2) / (n - 1), w_columns = (n / right + n / wrong - 4) / (n - 2);
  sum.mean = n * (r - 1) / (n - 1);
  sum.variance = 2 * n / (n - 3) * (v_rows - w_rows) * (v_columns - w_columns) + n * n / (n - 1) * w_rows * w_columns;
  return sum;
}

SumOfSquares within_sizes(std::span<const Level> levels) {
  std::map<double, std::vector<const Level*>> sizes;
  for (const Level& row : levels)
    if (row.total > 0) sizes[row.size].push_back(&row);
  SumOfSquares sum;
  for (const auto& [size, rows] : sizes) {
    const SumOfSquares one = within_one_size(rows);
    sum.value += one.value;
    sum.mean += one.mean;
    sum.variance += std::max(one.variance, 0.0);
  }
  return sum;
}

// A multiple of a chi-square with the same mean and variance (Satterthwaite 1946).
Dispersion ratio_of(const SumOfSquares& sum, double denominator_freedom) {
  if (!(sum.mean > 0) || !(sum.variance > 0)) return {};
  return {sum.value / sum.mean, 2 * sum.mean * sum.mean / sum.variance, denominator_freedom};
}

// The argument of the distribution for a ratio.
double scaled(const Dispersion& dispersion, double ratio) {
  return dispersion.denominator_freedom > 0 ? ratio : ratio * dispersion.degrees_of_freedom;
}

template <typename Function>
double with_law(const Dispersion& dispersion, const Function& function) {
  if (!(dispersion.degrees_of_freedom > 0)) return 1;
  if (dispersion.denominator_freedom > 0)
    return function(distribution::FisherF(dispersion.degrees_of_freedom, dispersion.denominator_freedom));
  return function(distribution::ChiSquared(dispersion.degrees_of_freedom));
}

}  // namespace

double Dispersion::p_more() const {
  return with_law(
      *this, [&](const auto& law) { return distribution::cdf(distribution::complement(law, scaled(*this, ratio))); });
}

double Dispersion::p_less() const {
  return with_law(*this, [&](const auto& law) { return distribution::cdf(law, scaled(*this, ratio)); });
}

double Dispersion::upper_limit(double probability) const {
  return with_law(*this, [&](const auto& law) {
    return distribution::quantile(distribution::complement(law, probability)) / scaled(*this, 1);
  });
}

double Dispersion::lower_limit(double probability) const {
  return with_law(*this, [&](const auto& law) { return distribution::quantile(law, probability) / scaled(*this, 1); });
}

Dispersions dispersions(const ModelResiduals& model, std::span<const Level> levels, std::span<const Direction> besides,
                        double clusters) {
  if (clusters == 1) return {};
  const std::vector<Direction> groups = orthogonal_groups(model, besides);
  SumOfSquares sum;
  for (const Direction& group : groups) sum.value += group.score * group.score;
  sum.mean = static_cast<double>(groups.size());
  sum.variance = 2 * sum.mean;
  if (clusters == 0) {
    const SumOfSquares within = within_sizes(levels);
    sum.value += within.value;
    sum.mean += within.mean;
    sum.variance += within.variance;
    return {ratio_of(sum, 0), ratio_of(sum, 0)};
  }
  const std::vector<double> covariance = cluster_covariance(model, levels, groups, clusters);
  SumOfSquares clustered{sum.value, 0, 0};
  for (std::size_t i = 0; i < groups.size(); ++i) clustered.mean += covariance[i * groups.size() + i];
  for (const double value : covariance) clustered.variance += 2 * value * value;
  const SumOfSquares& larger = clustered.mean > sum.mean ? clustered : sum;
  const SumOfSquares& smaller = clustered.mean > sum.mean ? sum : clustered;
  return {ratio_of(larger, clusters - 1), ratio_of(smaller, clusters - 1)};
}

}  // namespace todbench
