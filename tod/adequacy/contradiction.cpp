// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/adequacy/contradiction.h"

#include <algorithm>
#include <boost/math/special_functions/beta.hpp>
#include <map>
#include <vector>

#include "tod/psychometric/psychometric_model.h"

namespace todbench {
namespace {

/// Lowest and highest allowed proportion of correct answers at a size.
struct AllowedShare {
  double low = 0, high = 1;
};

/// P(at most `correct` of `total`), continued between whole numbers by the incomplete beta function.
double p_at_most(double correct, double total, double share) {
  if (correct >= total || share <= 0) return 1;
  return boost::math::ibeta(total - correct, correct + 1, std::clamp(1 - share, 0.0, 1.0));
}

/// Variance of the counts between the clusters of a size over that of independent answers, at least 1.
double common_variation(const std::vector<const Level*>& rows, double share) {
  std::map<int, Level> clusters;
  double total = 0;
  for (const Level* row : rows) {
    if (row->cluster < 0) return 1;
    clusters[row->cluster].correct += row->correct;
    clusters[row->cluster].total += row->total;
    total += row->total;
  }
  const auto n = static_cast<double>(clusters.size());
  if (n < 2 || share <= 0 || share >= 1) return 1;
  double squares = 0;
  for (const auto& [cluster, sum] : clusters)
    squares += (sum.correct - sum.total * share) * (sum.correct - sum.total * share);
  return std::max(1.0, n / (n - 1) * squares / (total * share * (1 - share)));
}

/// The most improbable size; `allowed` gives the AllowedShare of a size, `sides` is 2 if both ends of it count.
template <typename Allowed>
std::optional<Contradiction> strongest(std::span<const Level> levels, double probability, double sides,
                                       const Allowed& allowed) {
  std::map<double, std::vector<const Level*>> sizes;
  for (const Level& level : levels) {
    if (level.total > 0) sizes[level.size].push_back(&level);
  }
  std::optional<Contradiction> found;
  for (const auto& [size, rows] : sizes) {
    double correct = 0, total = 0;
    for (const Level* row : rows) correct += row->correct, total += row->total;
    const double share = correct / total, scale = 1 / common_variation(rows, share);
    const AllowedShare of = allowed(size);
    const bool low = share < of.low;
    if (!low && share <= of.high) continue;
    const double n = scale * total, c = scale * correct;
    const double p = low ? p_at_most(c, n, of.low) : p_at_most(n - c, n, 1 - of.high);
    const double any = std::min(1.0, p * sides * static_cast<double>(sizes.size()));
    if (any > probability || (found && any >= found->p)) continue;
    found = Contradiction{size, correct, total, low ? of.low : of.high, any};
  }
  return found;
}

}  // namespace

std::optional<Contradiction> below_chance(std::span<const Level> levels, double probability) {
  return strongest(levels, probability, 1, [](double) { return AllowedShare{.low = chance_level}; });
}

std::optional<Contradiction> contradicts_step(std::span<const Level> levels, const PsychometricFit& fit,
                                              PsychometricForm form, double probability) {
  if (fit.verdict != FitVerdict::step || !fit.threshold || !fit.slope) return std::nullopt;
  return strongest(levels, probability, 2, [&](double size) {
    const double fitted = psychometric(form, size, *fit.threshold, *fit.slope, fit.lapse);
    return size < *fit.threshold ? AllowedShare{chance_level, std::max(chance_level, fitted)}
                                 : AllowedShare{fitted, 1 - fit.lapse};
  });
}

}  // namespace todbench
