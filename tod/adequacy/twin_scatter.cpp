// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/adequacy/twin_scatter.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "acquisition/base/distributions.h"
#include "tod/psychometric/psychometric_model.h"
#include "tod/psychometric/twin_mean.h"

namespace todbench {
namespace {

/// Residuals from the function. No parameter is marked as fitted.
ModelResiduals twin_residuals(const PooledCounts& counts, const TwinMean& means) {
  ModelResiduals model{.counts = counts, .form = {}, .place = {}, .fitted = {}, .levels = {}};
  const auto add = [&](double ln_size, double right, double wrong, double mu, bool blank) {
    model.levels.push_back({.ln_size = ln_size,
                            .trials = right + wrong,
                            .right = mu,
                            .wrong = 1 - mu,
                            .logit = std::log(mu / (1 - mu)),
                            .residual = right * (1 - mu) - wrong * mu,
                            .catch_trials = blank});
  };
  for (const PooledLevel& level : counts.levels)
    add(level.ln_size, level.right, level.wrong, means.at(level.ln_size + std::log(counts.reference_size)).value,
        false);
  if (counts.blank_right + counts.blank_wrong > 0) add(0, counts.blank_right, counts.blank_wrong, chance_level, true);
  return model;
}

/// Directions of the fitted parameters, which reduce the residuals.
std::vector<Direction> fitted_directions(const ModelResiduals& model, const TwinMean& means,
                                         std::span<const std::size_t> fitted) {
  const Directions make(model);
  std::vector<Direction> directions;
  for (const std::size_t parameter : fitted) {
    std::vector<double> weights;
    for (const LevelResidual& level : model.levels) {
      const auto mean = means.at(level.ln_size + std::log(model.counts.reference_size));
      weights.push_back(level.catch_trials ? 0 : mean.gradient[parameter] / (level.right * level.wrong));
    }
    if (auto direction = make.direction(std::move(weights), directions)) directions.push_back(*std::move(direction));
  }
  return directions;
}

double number_of_clusters(std::span<const Level> levels) {
  std::set<int> clusters;
  for (const Level& level : levels)
    if (level.cluster >= 0 && level.total > 0) clusters.insert(level.cluster);
  return static_cast<double>(clusters.size());
}

}  // namespace

std::optional<Dispersions> twin_dispersions(std::span<const Level> levels, const PsychometricFit& fit,
                                            const FitOptions& options) {
  if (!fit.twin_shape || fit.dispersion || !fit.threshold) return std::nullopt;
  const auto shape = TwinShape::of(fit.twin_shape->table);
  const double clusters = number_of_clusters(levels);
  const PooledCounts counts = pool(levels);
  if (!shape || clusters == 1 || counts.levels.empty()) return std::nullopt;
  const TwinMean means(*shape, twin_place(*fit.twin_shape, fit.lapse));
  const ModelResiduals model = twin_residuals(counts, means);
  std::vector<std::size_t> fitted{twin_size};
  if (fit.twin_shape->slope_fitted) fitted.push_back(twin_slope);
  if (!options.fixed_lapse && fit.lapse > 0 && fit.lapse < max_free_lapse) fitted.push_back(twin_lapse);
  return dispersions(model, levels, fitted_directions(model, means, fitted), clusters);
}

std::optional<LapseTest> twin_lapse_test(const PsychometricFit& fit, const PsychometricFit& free_fit,
                                         double probability) {
  const double gain = twin_lapse_gain(fit, free_fit);
  if (!(gain > 0) || !(fit.clusters > 1)) return std::nullopt;
  const distribution::StudentsT law(fit.clusters - 1);
  const double limit = distribution::quantile(distribution::complement(law, probability));
  return LapseTest{free_fit.lapse, gain, limit * limit};
}

}  // namespace todbench
