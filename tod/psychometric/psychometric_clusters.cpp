// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/psychometric/psychometric_clusters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <vector>

#include "acquisition/base/distributions.h"
#include "tod/psychometric/clustered_variance.h"

namespace todbench {
namespace {

// Contribution of each trial: `right` for a right answer, `wrong` for a wrong one. Returns the sum over clusters of its
// square.
double sum_of_squares(std::span<const Level> levels, const std::map<double, std::array<double, 2>>& per_answer) {
  std::map<int, double> sums;
  double squares = 0;
  for (const Level& row : levels) {
    if (row.total <= 0 || row.size <= 0) continue;
    const auto& [right, wrong] = per_answer.at(row.size);
    const double wrong_count = row.total - row.correct;
    if (row.cluster < 0) {
      squares += row.correct * right * right + wrong_count * wrong * wrong;
    } else {
      sums[row.cluster] += row.correct * right + wrong_count * wrong;
    }
  }
  for (const auto& [cluster, sum] : sums) squares += sum * sum;
  return squares;
}

// Share of right answers at each given size.
std::map<double, std::array<double, 2>> residuals(std::span<const Level> levels) {
  std::map<double, std::array<double, 2>> counts;
  for (const Level& row : levels) {
    if (row.total <= 0 || row.size <= 0) continue;
    counts[row.size][0] += row.correct;
    counts[row.size][1] += row.total;
  }
  for (auto& [size, pair] : counts) {
    const double p = pair[0] / pair[1];
    pair = {1 - p, -p};
  }
  return counts;
}

double count_clusters(std::span<const Level> levels) {
  std::map<int, bool> seen;
  double alone = 0;
  for (const Level& row : levels) {
    if (row.total <= 0 || row.size <= 0) continue;
    if (row.cluster < 0) {
      alone += row.total;
    } else {
      seen[row.cluster] = true;
    }
  }
  return seen.empty() ? 0 : static_cast<double>(seen.size()) + alone;
}

// The first row of the inverse information: change of t per unit of score.
std::optional<std::array<double, 3>> influence(const Maximum<3>& maximum) {
  return solve_information(maximum.expansion.hessian, {1, 0, 0}, maximum.free, 0);
}

}  // namespace

ClusterEffect cluster_effect(std::span<const Level> levels, const PooledCounts& counts, PsychometricForm form,
                             const Maximum<3>& maximum, std::optional<double> se_t) {
  ClusterEffect effect;
  effect.clusters = count_clusters(levels);
  if (effect.clusters < 2) return effect;
  const double small_sample = effect.clusters / (effect.clusters - 1);
  std::map<double, std::array<double, 2>> per_answer = residuals(levels);
  const auto row = se_t ? influence(maximum) : std::nullopt;
  double independent = 0;
  if (row) {
    for (auto& [size, pair] : per_answer) {
      const Scores scores = scores_at(form, maximum.place, counts.relative(size));
      double right = 0, wrong = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        if (!maximum.free[i]) continue;
        right += (*row)[i] * scores.right[i];
        wrong += (*row)[i] * scores.wrong[i];
      }
      pair = {std::isfinite(right) ? right : 0, std::isfinite(wrong) ? wrong : 0};
    }
    independent = *se_t * *se_t;
  } else {
    for (const Level& level : levels)
      if (level.total > 0 && level.size > 0)
        independent += level.total * -per_answer[level.size][0] * per_answer[level.size][1];
  }
  if (independent > 0)
    effect.inflation = std::max(1.0, sum_of_squares(levels, per_answer) / independent * small_sample);
  return effect;
}

namespace {

// d mu / d parameter = psi (d ln psi / d parameter), over the free parameters.
AnswerScore score_of(const GradedAnswer& answer, const PooledCounts& counts, PsychometricForm form,
                     const Maximum<3>& maximum) {
  AnswerScore score{.direction = {},
                    .residual = 0,
                    .presentation = answer.presentation,
                    .place = answer.place,
                    .set_up = answer.set_up};
  const double ln_size = counts.relative(answer.size);
  const Link link = make_link(form, maximum.place[place_lapse]);
  const double slope = std::exp(maximum.place[place_q]);
  const LogProbabilities p = log_probabilities(link, link.sign * slope * (ln_size - maximum.place[place_t]));
  const double right = std::exp(p.right), sd = std::sqrt(right * std::exp(p.wrong));
  // An answer that the model determines has no variance to scale by.
  if (!(sd > 1e-12)) return score;
  score.residual = (answer.probability_correct - right) / sd;
  const Scores at = scores_at(form, maximum.place, ln_size);
  std::size_t parameter = 0;
  for (std::size_t k = 0; k < maximum.free.size(); ++k)
    if (maximum.free[k]) score.direction[parameter++] = right * at.right[k] / sd;
  return score;
}

}  // namespace

GradedEffect graded_effect(std::span<const GradedAnswer> answers, const PooledCounts& counts, PsychometricForm form,
                           const Maximum<3>& maximum, std::optional<double> se_t) {
  std::vector<AnswerScore> scores;
  std::set<int> presentations, places;
  for (const GradedAnswer& answer : answers) {
    if (!(answer.size > 0)) continue;
    presentations.insert(answer.presentation);
    places.insert(answer.place);
    scores.push_back(score_of(answer, counts, form, maximum));
  }
  GradedEffect effect;
  effect.clusters.clusters = std::max(1.0, static_cast<double>(std::min(presentations.size(), places.size())));
  if (!se_t || !maximum.free[place_t]) return effect;
  const auto parameters = static_cast<std::size_t>(std::ranges::count(maximum.free, true));
  const ClusteredVariance found = clustered_variance(scores, parameters, 0);
  effect.dispersion = found.dispersion;
  effect.kind = found.kind;
  if (!std::isfinite(found.variance)) return effect;
  effect.clusters = {.clusters = found.degrees_of_freedom + 1, .inflation = found.variance / (*se_t * *se_t)};
  return effect;
}

double confidence_drop(const ClusterEffect& effect, double confidence) {
  const double tail = (1 - confidence) / 2;
  if (effect.clusters != 0 && effect.clusters < 2) return std::numeric_limits<double>::infinity();
  const double z = distribution::quantile_above(
      tail, effect.clusters == 0 ? std::nullopt : std::optional<double>(effect.clusters - 1));
  return effect.inflation * z * z;
}

}  // namespace todbench
