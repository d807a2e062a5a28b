// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/observer_fit/people.h"

#include <algorithm>
#include <cmath>

#include "acquisition/base/distributions.h"

namespace todbench {
namespace {

struct Weighted {
  double weight = 0, weight2 = 0, mean = 0, q = 0;
};

/// Weighted mean of the estimates with weights 1 / (se^2 + between).
Weighted weighted(std::span<const PersonEstimate> estimates, double between) {
  Weighted out;
  for (const auto& e : estimates) {
    const double w = 1 / (e.se * e.se + between);
    out.weight += w;
    out.weight2 += w * w;
    out.mean += w * e.value;
  }
  out.mean /= out.weight;
  for (const auto& e : estimates) out.q += std::pow(e.value - out.mean, 2) / (e.se * e.se + between);
  return out;
}

/// Upper end of the search for the variance between people: far above the spread of the estimates.
double most_between(std::span<const PersonEstimate> estimates) {
  const auto [low, high] = std::minmax_element(estimates.begin(), estimates.end(),
                                               [](const auto& a, const auto& b) { return a.value < b.value; });
  return 400 * std::pow(high->value - low->value, 2) + 1e-12;
}

/// The variance at which a falling function is 0; 0 if it begins below, empty if it does not reach 0.
template <typename Function>
std::optional<double> falls_to_zero(const Function& f, double most) {
  if (f(0) <= 0) return 0.0;
  if (f(most) > 0) return std::nullopt;
  double low = 0, high = most;
  for (int i = 0; i < 200 && high - low > 1e-12 * most; ++i) {
    const double middle = (low + high) / 2;
    (f(middle) > 0 ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// ln restricted likelihood of a variance between people, up to a constant.
double restricted(std::span<const PersonEstimate> estimates, double between) {
  const Weighted at = weighted(estimates, between);
  double sum = -0.5 * std::log(at.weight) - 0.5 * at.q;
  for (const auto& e : estimates) sum -= 0.5 * std::log(e.se * e.se + between);
  return sum;
}

/// The highest restricted likelihood over a fine lattice of the standard deviation, refined by thirds.
double most_likely_between(std::span<const PersonEstimate> estimates) {
  const auto [low, high] = std::minmax_element(estimates.begin(), estimates.end(),
                                               [](const auto& a, const auto& b) { return a.value < b.value; });
  const double range = high->value - low->value;
  constexpr int steps = 400;
  int best = 0;
  for (int i = 1; i <= steps; ++i) {
    if (restricted(estimates, std::pow(range * i / steps, 2)) >
        restricted(estimates, std::pow(range * best / steps, 2)))
      best = i;
  }
  double a = range * std::max(0, best - 1) / steps, b = range * std::min(steps, best + 1) / steps;
  for (int i = 0; i < 60; ++i) {
    const double third = (b - a) / 3;
    (restricted(estimates, std::pow(a + third, 2)) < restricted(estimates, std::pow(b - third, 2)) ? a : b) +=
        restricted(estimates, std::pow(a + third, 2)) < restricted(estimates, std::pow(b - third, 2)) ? third : -third;
  }
  const double found = (a + b) / 2;
  return restricted(estimates, 0) >= restricted(estimates, found * found) ? 0 : found * found;
}

}  // namespace

PeopleSpread spread_over(std::span<const PersonEstimate> estimates) {
  PeopleSpread out;
  out.persons = static_cast<int>(estimates.size());
  if (estimates.size() < 2) return out;
  const double degrees = out.persons - 1;
  const distribution::ChiSquared chi2(degrees);
  const double between = most_likely_between(estimates);
  const Weighted at = weighted(estimates, between);
  out.mean = at.mean;
  out.between_sd = std::sqrt(between);
  // At least the interval of a known variance: agreement by chance does not make a mean exact.
  const double se = std::sqrt(std::max(1.0, at.q / degrees) / at.weight);
  const double half = distribution::quantile(distribution::StudentsT(degrees), 0.975) * se;
  out.mean_ci95 = {at.mean - half, at.mean + half};
  const double most = most_between(estimates);
  const auto root = [](const std::optional<double>& v) { return v ? std::optional(std::sqrt(*v)) : std::nullopt; };
  const auto above = [&](double quantile) {
    return [&estimates, quantile](double variance) { return weighted(estimates, variance).q - quantile; };
  };
  out.between_sd_ci95 = {root(falls_to_zero(above(distribution::quantile(chi2, 0.975)), most)),
                         root(falls_to_zero(above(distribution::quantile(chi2, 0.025)), most))};
  out.heterogeneity_p = distribution::cdf(distribution::complement(chi2, weighted(estimates, 0).q));
  return out;
}

PeopleSpread people_spread(std::span<const PersonFit> people, std::size_t key) {
  std::vector<PersonEstimate> estimates;
  const bool logarithmic = all_observer_keys[key] != ObserverKey::lapse;
  for (const PersonFit& fit : people) {
    const auto se = standard_error(fit, key);
    if (se && *se > 0 && std::isfinite(*se))
      estimates.push_back({logarithmic ? std::log(fit.values[key]) : fit.values[key], *se});
  }
  PeopleSpread out = spread_over(estimates);
  const auto value = [&](std::optional<double>& at) {
    if (at) at = logarithmic ? std::exp(*at) : std::max(0.0, *at);
  };
  value(out.mean);
  value(out.mean_ci95.low);
  value(out.mean_ci95.high);
  return out;
}

}  // namespace todbench
