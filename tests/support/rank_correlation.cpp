// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/rank_correlation.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <vector>

#include "acquisition/base/rng.h"

namespace todbench {
namespace {

constexpr double rounding = 1e-9;  ///< of a coefficient: equal coefficients compare equal

/// Ranks from 1, minus their mean. Equal values share the mean of their ranks.
std::vector<double> centred_ranks(std::span<const double> values) {
  const std::size_t n = values.size();
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t k) { return values[i] < values[k]; });
  std::vector<double> ranks(n);
  for (std::size_t first = 0, last = 0; first < n; first = last) {
    while (last < n && values[order[last]] == values[order[first]]) ++last;
    const double rank = 0.5 * static_cast<double>(first + last + 1) - 0.5 * static_cast<double>(n + 1);
    for (std::size_t k = first; k < last; ++k) ranks[order[k]] = rank;
  }
  return ranks;
}

double coefficient(std::span<const double> a, std::span<const double> b) {
  const auto x = centred_ranks(a), y = centred_ranks(b);
  const double xy = std::inner_product(x.begin(), x.end(), y.begin(), 0.0);
  return xy / std::sqrt(std::inner_product(x.begin(), x.end(), x.begin(), 0.0) *
                        std::inner_product(y.begin(), y.end(), y.begin(), 0.0));
}

/// Simulated samples of `items` pairs with the same normal numbers for every correlation.
class SimulatedSamples {
 public:
  SimulatedSamples(std::size_t items, const RankCorrelationOptions& options)
      : items_(items),
        draws_(static_cast<std::size_t>(options.draws)),
        normals_(2 * items * draws_),
        a_(items),
        b_(items) {
    RandomStream(options.seed, "rank_correlation").fill_normal(normals_);
  }
  /// Share of samples of a normal correlation whose coefficient is `wanted`.
  template <typename Wanted>
  double share(double correlation, Wanted wanted) {
    const double rest = std::sqrt(1 - correlation * correlation);
    std::size_t found = 0;
    for (std::size_t draw = 0; draw < draws_; ++draw) {
      const float* numbers = normals_.data() + 2 * items_ * draw;
      for (std::size_t i = 0; i < items_; ++i) {
        a_[i] = static_cast<double>(numbers[i]);
        b_[i] = correlation * a_[i] + rest * static_cast<double>(numbers[items_ + i]);
      }
      found += wanted(coefficient(a_, b_)) ? 1 : 0;
    }
    return static_cast<double>(found) / static_cast<double>(draws_);
  }

 private:
  std::size_t items_, draws_;
  std::vector<float> normals_;
  std::vector<double> a_, b_;
};

/// The normal correlation at which `share`, which rises from `from` towards `to`, passes 2.5 %.
double limit(double from, double to, const std::function<double(double)>& share) {
  for (int step = 0; step < 20; ++step) {
    const double middle = 0.5 * (from + to);
    (share(middle) < 0.025 ? from : to) = middle;
  }
  return 0.5 * (from + to);
}

/// Spearman's coefficient of a bivariate normal population (Kruskal 1958).
double of_population(double correlation) {
  return 6 / std::numbers::pi * std::asin(correlation / 2);
}

Result<void> check(std::span<const double> a, std::span<const double> b) {
  if (a.size() != b.size()) return fail(ErrorCode::invalid_input, "both rankings need a value for every item");
  if (a.size() < 4) return fail(ErrorCode::invalid_input, "a rank correlation needs at least four items");
  for (const auto& values : {a, b}) {
    if (!std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); }))
      return fail(ErrorCode::invalid_input, "a rank correlation needs finite values");
    if (std::all_of(values.begin(), values.end(), [&](double value) { return value == values.front(); }))
      return fail(ErrorCode::invalid_input, "equal values have no ranking");
  }
  return {};
}

}  // namespace

Result<RankCorrelation> rank_correlation(std::span<const double> a, std::span<const double> b,
                                         const RankCorrelationOptions& options) {
  if (auto fine = check(a, b); !fine) return tl::unexpected(fine.error());
  RankCorrelation out{.rho = coefficient(a, b)};
  SimulatedSamples samples(a.size(), options);
  const double rho = out.rho;
  // The sample itself counts as one of the draws: no finite number of them gives a probability of 0.
  const double as_far = samples.share(0, [&](double found) { return std::abs(found) >= std::abs(rho) - rounding; });
  out.p = (as_far * options.draws + 1) / (options.draws + 1);
  const auto at_least = [&](double r) { return samples.share(r, [&](double x) { return x >= rho - rounding; }); };
  const auto at_most = [&](double r) { return samples.share(r, [&](double x) { return x <= rho + rounding; }); };
  out.ci95 = {rho <= rounding - 1 ? -1 : of_population(limit(-1, 1, at_least)),
              rho >= 1 - rounding ? 1 : of_population(limit(1, -1, at_most))};
  return out;
}

}  // namespace todbench
