// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/adequacy/residual_directions.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace todbench {
namespace {

constexpr double largest_logit = 50;  // e^-50: no answer of that kind in any number of trials

double logit_of(const LogProbabilities& p) {
  return std::clamp(p.right - p.wrong, -largest_logit, largest_logit);
}

void subtract_projection(std::vector<double>& from, const std::vector<double>& unit, double product) {
  for (std::size_t i = 0; i < from.size(); ++i) from[i] -= product * unit[i];
}

// Index of a row's level; catch trials are the last one.
std::size_t level_of(const ModelResiduals& model, const Level& row) {
  if (row.size <= 0) return model.levels.size() - 1;
  const double ln_size = model.counts.relative(row.size);
  const auto& levels = model.counts.levels;
  const auto above = std::lower_bound(levels.begin(), levels.end(), ln_size,
                                      [](const PooledLevel& level, double x) { return level.ln_size < x; });
  if (above == levels.begin()) return 0;
  const auto i = static_cast<std::size_t>(above - levels.begin());
  if (above == levels.end()) return i - 1;
  return levels[i].ln_size - ln_size < ln_size - levels[i - 1].ln_size ? i : i - 1;
}

}  // namespace

ModelResiduals model_residuals(const PooledCounts& counts, PsychometricForm form, const PsychometricPlace& place,
                               const std::array<bool, 3>& fitted) {
  ModelResiduals model{counts, form, place, fitted, {}};
  const Link link = make_link(form, place[place_lapse]);
  const double slope = std::exp(place[place_q]);
  for (const PooledLevel& level : counts.levels) {
    const LogProbabilities p = log_probabilities(link, link.sign * slope * (level.ln_size - place[place_t]));
    LevelResidual r{level.ln_size, level.total(), std::exp(p.right), std::exp(p.wrong), logit_of(p), 0, false};
    r.residual = level.right * r.wrong - level.wrong * r.right;
    model.levels.push_back(r);
  }
  if (const double blank = counts.blank_right + counts.blank_wrong; blank > 0) {
    LevelResidual r{0, blank, chance_level, 1 - chance_level, std::log(chance_level / (1 - chance_level)), 0, true};
    r.residual = counts.blank_right * r.wrong - counts.blank_wrong * r.right;
    model.levels.push_back(r);
  }
  return model;
}

std::vector<double> logits_at(const ModelResiduals& model, PsychometricForm form, const PsychometricPlace& place) {
  const Link link = make_link(form, place[place_lapse]);
  const double slope = std::exp(place[place_q]);
  std::vector<double> logits;
  for (const LevelResidual& level : model.levels) {
    const double u = link.sign * slope * (level.ln_size - place[place_t]);
    logits.push_back(level.catch_trials ? level.logit : logit_of(log_probabilities(link, u)));
  }
  return logits;
}

Directions::Directions(const ModelResiduals& model) : model_(model) {
  for (std::size_t parameter = 0; parameter < 3; ++parameter) {
    if (!model.fitted[parameter]) continue;
    std::vector<double> weights;
    for (const LevelResidual& level : model.levels) {
      if (level.catch_trials) {
        weights.push_back(0);
        continue;
      }
      // (d psi) / (psi (1 - psi)) is d ln psi - d ln(1 - psi).
      const Scores scores = scores_at(model.form, model.place, level.ln_size);
      const double weight = scores.right[parameter] - scores.wrong[parameter];
      weights.push_back(std::isfinite(weight) && level.variance() > 0 ? weight : 0);
    }
    const double whole = product(weights, weights);
    for (const auto& earlier : parameters_) subtract_projection(weights, earlier, product(weights, earlier));
    const double rest = product(weights, weights);
    constexpr double dependent = 1e-9;
    if (!(rest > dependent * whole)) continue;
    for (double& weight : weights) weight /= std::sqrt(rest);
    parameters_.push_back(std::move(weights));
  }
}

double Directions::product(const std::vector<double>& a, const std::vector<double>& b) const {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += model_.levels[i].variance() * a[i] * b[i];
  return sum;
}

std::optional<Direction> Directions::direction(std::vector<double> weights, std::span<const Direction> besides) const {
  const double whole = product(weights, weights);
  for (const auto& parameter : parameters_) subtract_projection(weights, parameter, product(weights, parameter));
  for (const Direction& other : besides) subtract_projection(weights, other.weights, product(weights, other.weights));
  const double rest = product(weights, weights);
  constexpr double too_little = 0.01;
  if (!(rest > too_little * whole) || !std::isfinite(rest)) return std::nullopt;
  Direction direction{std::move(weights), 0};
  for (std::size_t i = 0; i < direction.weights.size(); ++i) {
    direction.weights[i] /= std::sqrt(rest);
    direction.score += direction.weights[i] * model_.levels[i].residual;
  }
  return direction;
}

std::vector<double> cluster_covariance(const ModelResiduals& model, std::span<const Level> levels,
                                       std::span<const Direction> directions, double clusters) {
  const std::size_t n = directions.size();
  std::vector<double> covariance(n * n, 0.0);
  const auto add_square = [&](const std::vector<double>& sums, double times) {
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) covariance[i * n + j] += times * sums[i] * sums[j];
  };
  std::map<int, std::vector<double>> sums;
  std::vector<double> of_trial(n);
  for (const Level& row : levels) {
    if (row.total <= 0) continue;
    const std::size_t at = level_of(model, row);
    const LevelResidual& level = model.levels[at];
    if (row.cluster >= 0) {
      std::vector<double>& sum = sums.try_emplace(row.cluster, n, 0.0).first->second;
      const double residual = row.correct * level.wrong - (row.total - row.correct) * level.right;
      for (std::size_t i = 0; i < n; ++i) sum[i] += directions[i].weights[at] * residual;
      continue;
    }
    for (const auto& [times, residual] :
         {std::pair(row.correct, level.wrong), std::pair(row.total - row.correct, -level.right)}) {
      for (std::size_t i = 0; i < n; ++i) of_trial[i] = directions[i].weights[at] * residual;
      add_square(of_trial, times);
    }
  }
  for (const auto& [cluster, sum] : sums) add_square(sum, 1);
  for (double& value : covariance) value *= clusters / (clusters - 1);
  return covariance;
}

}  // namespace todbench
