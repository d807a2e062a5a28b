// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/round_robin/consensus.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "acquisition/base/distributions.h"
#include "acquisition/base/median.h"
#include "acquisition/base/rng.h"

namespace todbench {
namespace {

/// Sums with weights 1/(u^2 + variance).
struct WeightedSums {
  double weight = 0, weight2 = 0, mean = 0, q = 0;
};

WeightedSums weighted_sums(std::span<const LaboratoryValue> values, double variance) {
  WeightedSums out;
  // The differences from the first value are averaged: 100000.1 and 100000.2 lose no digits.
  const double first = values.front().value;
  for (const LaboratoryValue& v : values) {
    const double w = 1 / (v.u * v.u + variance);
    out.weight += w;
    out.weight2 += w * w;
    out.mean += w * (v.value - first);
  }
  out.mean = first + out.mean / out.weight;
  for (const LaboratoryValue& v : values) out.q += std::pow(v.value - out.mean, 2) / (v.u * v.u + variance);
  return out;
}

/// Shortest interval with 95 % of the sorted draws (Cox 2002, appendix; JCGM 101:2008, 5.3.4).
Interval shortest_95(std::vector<double> draws) {
  std::sort(draws.begin(), draws.end());
  const auto inside = static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(draws.size())));
  std::size_t best = 0;
  for (std::size_t i = 0; i + inside < draws.size(); ++i) {
    if (draws[i + inside] - draws[i] < draws[best + inside] - draws[best]) best = i;
  }
  return {draws[best], draws[std::min(best + inside, draws.size() - 1)]};
}

std::vector<LaboratoryValue> chosen(std::span<const LaboratoryValue> values, std::span<const std::size_t> which) {
  std::vector<LaboratoryValue> out;
  for (const std::size_t i : which) out.push_back(values[i]);
  return out;
}

std::vector<std::size_t> members(std::uint32_t mask) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; mask >> i; ++i) {
    if (mask >> i & 1u) out.push_back(i);
  }
  return out;
}

std::vector<std::size_t> by_every_subset(std::span<const LaboratoryValue> values) {
  std::vector<std::size_t> best{0};
  double best_chi2 = 0;
  const std::uint32_t all = (1u << values.size()) - 1;
  for (std::uint32_t mask = 1; mask <= all; ++mask) {
    const auto size = static_cast<std::size_t>(std::popcount(mask));
    if (size < 2 || size < best.size()) continue;
    const auto which = members(mask);
    const ConsistencyCheck check = consistency(chosen(values, which));
    if (!check.consistent() || (size == best.size() && check.chi2 >= best_chi2)) continue;
    best = which;
    best_chi2 = check.chi2;
  }
  return best;
}

std::vector<std::size_t> by_removal(std::span<const LaboratoryValue> values) {
  std::vector<std::size_t> rest(values.size());
  for (std::size_t i = 0; i < rest.size(); ++i) rest[i] = i;
  while (rest.size() > 1) {
    const auto kept = chosen(values, rest);
    if (consistency(kept).consistent()) break;
    const auto farness = [&](std::size_t i) {
      std::vector<std::size_t> others = rest;
      std::erase(others, i);
      const Consensus mean = weighted_mean(chosen(values, others));
      return std::abs(values[i].value - mean.value) / std::hypot(values[i].u, mean.u);
    };
    rest.erase(std::max_element(rest.begin(), rest.end(),
                                [&](std::size_t a, std::size_t b) { return farness(a) < farness(b); }));
  }
  return rest;
}

}  // namespace

Consensus weighted_mean(std::span<const LaboratoryValue> values) {
  const WeightedSums sums = weighted_sums(values, 0);
  return {sums.mean, 1 / std::sqrt(sums.weight)};
}

ConsistencyCheck consistency(std::span<const LaboratoryValue> values) {
  ConsistencyCheck out;
  out.chi2 = weighted_sums(values, 0).q;
  out.degrees_of_freedom = static_cast<int>(values.size()) - 1;
  if (out.degrees_of_freedom < 1) return out;
  out.p = distribution::cdf(distribution::complement(distribution::ChiSquared(out.degrees_of_freedom), out.chi2));
  out.birge_ratio = std::sqrt(out.chi2 / out.degrees_of_freedom);
  return out;
}

std::vector<std::size_t> largest_consistent_subset(std::span<const LaboratoryValue> values) {
  constexpr std::size_t most_tried = 16;
  return values.size() <= most_tried ? by_every_subset(values) : by_removal(values);
}

MedianConsensus monte_carlo_median(std::span<const LaboratoryValue> values, std::uint64_t seed, MedianDetail detail) {
  const RandomStream stream(seed, "round_robin.median");
  const std::size_t n = values.size();
  std::vector<double> medians, drawn(n);
  std::vector<std::vector<double>> differences(detail == MedianDetail::differences ? n : 0);
  std::vector<float> noise(n * median_draws);
  stream.fill_normal(noise);
  double sum = 0, squares = 0;
  const double first = values.front().value;
  for (std::size_t r = 0; r < median_draws; ++r) {
    for (std::size_t i = 0; i < n; ++i)
      drawn[i] = values[i].value - first + values[i].u * static_cast<double>(noise[r * n + i]);
    const double middle = median(drawn);
    medians.push_back(middle);
    sum += middle;
    for (std::size_t i = 0; i < differences.size(); ++i) differences[i].push_back(drawn[i] - middle);
  }
  const double mean = sum / median_draws;
  for (const double m : medians) squares += (m - mean) * (m - mean);
  MedianConsensus out;
  out.median = {first + mean, std::sqrt(squares / (median_draws - 1))};
  const Interval range = shortest_95(std::move(medians));
  out.ci95 = {first + *range.low, first + *range.high};
  for (auto& d : differences) {
    const Interval inner = shortest_95(std::move(d));
    out.difference_half95.push_back((*inner.high - *inner.low) / 2);
  }
  return out;
}

double dersimonian_laird_variance(std::span<const LaboratoryValue> values) {
  const WeightedSums sums = weighted_sums(values, 0);
  const double excess = sums.q - static_cast<double>(values.size() - 1);
  return std::max(0.0, excess / (sums.weight - sums.weight2 / sums.weight));
}

double paule_mandel_variance(std::span<const LaboratoryValue> values) {
  const auto expected = static_cast<double>(values.size() - 1);
  const auto excess = [&](double variance) { return weighted_sums(values, variance).q - expected; };
  if (excess(0) <= 0) return 0;
  const auto [least, most] =
      std::minmax_element(values.begin(), values.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  // The generalised chi2 falls with the variance, and at the square of the range it is below N / 4 * range^2 /
  // variance.
  double low = 0, high = std::pow(most->value - least->value, 2);
  for (int i = 0; i < 200 && high - low > 1e-14 * high; ++i) {
    const double middle = (low + high) / 2;
    (excess(middle) > 0 ? low : high) = middle;
  }
  return (low + high) / 2;
}

RandomEffects random_effects(std::span<const LaboratoryValue> values, double variance) {
  const WeightedSums sums = weighted_sums(values, variance);
  const double u = 1 / std::sqrt(sums.weight);
  const double q = sums.q / static_cast<double>(values.size() - 1);
  return {{sums.mean, u}, u * std::sqrt(std::max(1.0, q))};
}

}  // namespace todbench
