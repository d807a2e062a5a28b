#include "tod/psychometric/psychometric_clusters.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <map>

namespace todbench {
namespace {

// Something each trial adds: `right` for a right answer, `wrong` for a wrong one. Its square summed over clusters.
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

// Share of right answers at each size given.
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

// The first row of the inverse information: what one unit of score moves t.
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

double confidence_drop(const ClusterEffect& effect, double confidence) {
  const double tail = (1 - confidence) / 2;
  double z = 0;
  if (effect.clusters == 0) {
    z = boost::math::quantile(boost::math::complement(boost::math::normal(), tail));
  } else if (effect.clusters < 2) {
    return std::numeric_limits<double>::infinity();
  } else {
    z = boost::math::quantile(boost::math::complement(boost::math::students_t(effect.clusters - 1), tail));
  }
  return effect.inflation * z * z;
}

}  // namespace todbench
