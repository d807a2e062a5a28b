// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/psychometric/psychometric_posterior.h"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace todbench {
namespace {

constexpr double prior_sd_q = 0.6;
constexpr double prior_mean_q = 1.252762968495368;  // ln 3.5

double ln_prior(double q) {
  const double x = (q - prior_mean_q) / prior_sd_q;
  return -x * x / 2;
}

enum class LapseRule { coarse, fine };  // Gauss-Legendre with 6 or 12 points
struct GridSize {
  std::size_t t = 0, q = 0;
};

// Unnormalised marginal densities and their nodes.
struct Marginals {
  std::vector<double> t, q, lapse;
  std::vector<double> lapse_nodes;
};

std::vector<double> equal_steps(double low, double high, std::size_t count) {
  std::vector<double> nodes;
  for (std::size_t i = 0; i < count; ++i)
    nodes.push_back(i + 1 == count ? high
                                   : low + (high - low) * static_cast<double>(i) / static_cast<double>(count - 1));
  return nodes;
}

// Nodes and weights in the lapse; one node for a fixed lapse.
using NodesAndWeights = std::vector<std::pair<double, double>>;

template <unsigned points>
NodesAndWeights gauss_legendre(double low, double high) {
  using Gauss = boost::math::quadrature::gauss<double, points>;
  NodesAndWeights rule;
  const double centre = (low + high) / 2, half = (high - low) / 2;
  for (std::size_t i = 0; i < Gauss::abscissa().size(); ++i) {
    rule.emplace_back(centre - half * Gauss::abscissa()[i], half * Gauss::weights()[i]);
    rule.emplace_back(centre + half * Gauss::abscissa()[i], half * Gauss::weights()[i]);
  }
  std::sort(rule.begin(), rule.end());
  return rule;
}

NodesAndWeights lapse_rule(double low, double high, LapseRule rule) {
  if (!(low < high)) return {{low, 1.0}};
  return rule == LapseRule::coarse ? gauss_legendre<6>(low, high) : gauss_legendre<12>(low, high);
}

// The psychometric function at each node of the lapse.
struct LapseTables {
  NodesAndWeights rule;
  std::vector<LinkTable> links;
};

LapseTables lapse_tables(PsychometricForm form, double low, double high, LapseRule wanted) {
  LapseTables tables{lapse_rule(low, high, wanted), {}};
  for (const auto& [lapse, weight] : tables.rule) tables.links.emplace_back(make_link(form, lapse));
  return tables;
}

// ln density at the nodes of a window, in the order [lapse][q][t].
struct DensityGrid {
  GridSize size;
  std::vector<double> ln_density;

  [[nodiscard]] double at(std::size_t lapse, std::size_t q, std::size_t t) const {
    return ln_density[(lapse * size.q + q) * size.t + t];
  }
};

// Takes every second node of t and q from a `coarser` grid over the same window if there is one with half the steps;
// the places are identical to the last bit.
DensityGrid evaluate(const PooledCounts& counts, const LapseTables& tables, const ParameterBox<3>& window,
                     GridSize size, const DensityGrid& coarser) {
  const std::vector<double> ts = equal_steps(window.lower[place_t], window.upper[place_t], size.t);
  const std::vector<double> qs = equal_steps(window.lower[place_q], window.upper[place_q], size.q);
  const bool halved = size.t == 2 * coarser.size.t - 1 && size.q == 2 * coarser.size.q - 1;
  std::vector<double> between;
  for (std::size_t i = 1; i < size.t; i += 2) between.push_back(ts[i]);
  DensityGrid grid{size, std::vector<double>(tables.rule.size() * size.q * size.t)};
  auto value = grid.ln_density.begin();
  for (std::size_t k = 0; k < tables.rule.size(); ++k) {
    const CountsTable likelihood(tables.links[k], counts);  // one at a time: together they would not fit into the cache
    for (std::size_t j = 0; j < size.q; ++j, value += static_cast<std::ptrdiff_t>(size.t)) {
      const bool known = halved && j % 2 == 0;
      const double prior = ln_prior(qs[j]);
      const auto fresh = likelihood.log_likelihoods(known ? between : ts, std::exp(qs[j]));
      for (std::size_t i = 0; i < size.t; ++i) {
        const double ln_density = known && i % 2 == 0 ? coarser.at(k, j / 2, i / 2) : fresh[known ? i / 2 : i] + prior;
        value[static_cast<std::ptrdiff_t>(i)] = ln_density;
      }
    }
  }
  return grid;
}

Marginals integrate(const DensityGrid& grid, const NodesAndWeights& rule) {
  const GridSize size = grid.size;
  const double peak = *std::max_element(grid.ln_density.begin(), grid.ln_density.end());
  Marginals m{std::vector<double>(size.t), std::vector<double>(size.q), std::vector<double>(rule.size()), {}};
  auto value = grid.ln_density.begin();
  for (std::size_t k = 0; k < rule.size(); ++k) {
    m.lapse_nodes.push_back(rule[k].first);
    for (std::size_t j = 0; j < size.q; ++j) {
      const double weight_q = j == 0 || j + 1 == size.q ? 0.5 : 1.0;
      for (std::size_t i = 0; i < size.t; ++i, ++value) {
        if (*value < peak - 45) continue;  // e^-45 = 3e-20 of the peak
        const double density = std::exp(*value - peak);
        m.t[i] += density * weight_q * rule[k].second;
        m.q[j] += density * rule[k].second;
        m.lapse[k] += density * weight_q;
      }
    }
  }
  return m;
}

// The maximum of the posterior, climbed from the best node of the scan.
Maximum<3> mode(const PooledCounts& counts, PsychometricForm form, const std::vector<ScanNode>& nodes,
                const ParameterBox<3>& prior) {
  const auto density = [&](const PsychometricPlace& place) {
    Expansion<3> e = expand_likelihood(counts, form, place);
    e.value += ln_prior(place[place_q]);
    e.gradient[place_q] -= (place[place_q] - prior_mean_q) / (prior_sd_q * prior_sd_q);
    e.hessian[place_q][place_q] -= 1 / (prior_sd_q * prior_sd_q);
    return e;
  };
  const auto best = std::max_element(nodes.begin(), nodes.end(), [](const ScanNode& a, const ScanNode& b) {
    return a.value + ln_prior(a.place[place_q]) < b.value + ln_prior(b.place[place_q]);
  });
  return climb<3>(density, best->place, prior);
}

// Mode +- 8 standard deviations of the normal approximation, and every scanned place within e^-18 of the mode.
ParameterBox<3> first_window(const Maximum<3>& mode, const std::vector<ScanNode>& nodes, const ParameterBox<3>& prior,
                             double blank) {
  ParameterBox<3> window{mode.place, mode.place};
  const auto include = [&](std::size_t i, double low, double high) {
    window.lower[i] = std::clamp(low, prior.lower[i], window.lower[i]);
    window.upper[i] = std::clamp(high, window.upper[i], prior.upper[i]);
  };
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(prior.lower[i] < prior.upper[i])) continue;
    const double range = prior.upper[i] - prior.lower[i];
    std::array<bool, 3> all{};
    for (std::size_t j = 0; j < 3; ++j) all[j] = mode.free[j] || j == i;
    std::array<double, 3> unit{};
    unit[i] = 1;
    const auto column = solve_information(mode.expansion.hessian, unit, all, 0);
    double reach = range / 4;
    if (column && (*column)[i] > 0) reach = std::min(8 * std::sqrt((*column)[i]), range);
    // At a limit with a slope outwards the density falls exponentially.
    if (!mode.free[i] && mode.expansion.gradient[i] != 0)
      reach = std::min(std::max(reach, 20 / std::abs(mode.expansion.gradient[i])), range);
    include(i, mode.place[i] - reach, mode.place[i] + reach);
  }
  for (const ScanNode& node : nodes) {
    if (node.value + blank + ln_prior(node.place[place_q]) < mode.expansion.value - 18) continue;
    for (std::size_t i = 0; i < 3; ++i)
      if (prior.lower[i] < prior.upper[i]) include(i, node.place[i], node.place[i]);
  }
  return window;
}

struct Span {
  double low, high;
  bool changed;
};

// Widens a side whose edge still has mass, narrows one that is empty.
Span adjusted(const std::vector<double>& nodes, const std::vector<double>& density, Span now, double least,
              double most) {
  constexpr double negligible = 1e-7;
  const double peak = *std::max_element(density.begin(), density.end());
  const double width = now.high - now.low;
  Span next{now.low, now.high, false};
  if (density.front() > negligible * peak && now.low > least) next.low = std::max(least, now.low - width / 2);
  if (density.back() > negligible * peak && now.high < most) next.high = std::min(most, now.high + width / 2);
  if (next.low < now.low || next.high > now.high) {
    next.changed = true;
    return next;
  }
  std::size_t first = 0, last = density.size() - 1;
  while (first < last && density[first] < negligible * peak / 10) ++first;
  while (last > first && density[last] < negligible * peak / 10) --last;
  const double low = first > 0 ? nodes[first - 1] : now.low;
  const double high = last + 1 < density.size() ? nodes[last + 1] : now.high;
  if (high - low < 0.75 * width) return {low, high, true};
  return next;
}

ParameterBox<3> settled_window(const PooledCounts& counts, PsychometricForm form, ParameterBox<3> window,
                               const ParameterBox<3>& prior) {
  constexpr GridSize coarse{33, 21};
  constexpr int most_rounds = 16;
  std::optional<LapseTables> tables;
  const auto lapses = [&] { return std::pair(window.lower[place_lapse], window.upper[place_lapse]); };
  auto tabulated = lapses();
  for (int round = 0; round < most_rounds; ++round) {
    if (!tables || tabulated != lapses()) {
      tabulated = lapses();
      tables = lapse_tables(form, tabulated.first, tabulated.second, LapseRule::coarse);
    }
    const Marginals m = integrate(evaluate(counts, *tables, window, coarse, {}), tables->rule);
    bool changed = false;
    const auto adjust = [&](std::size_t i, const std::vector<double>& nodes, const std::vector<double>& density) {
      const Span span =
          adjusted(nodes, density, {window.lower[i], window.upper[i], false}, prior.lower[i], prior.upper[i]);
      window.lower[i] = span.low;
      window.upper[i] = span.high;
      changed = changed || span.changed;
    };
    adjust(place_t, equal_steps(window.lower[place_t], window.upper[place_t], coarse.t), m.t);
    adjust(place_q, equal_steps(window.lower[place_q], window.upper[place_q], coarse.q), m.q);
    if (m.lapse.size() > 1) adjust(place_lapse, m.lapse_nodes, m.lapse);
    if (!changed) break;
  }
  return window;
}

// A sampled density between its nodes: its logarithm is a cubic through four neighbours, exact for a normal density.
class SmoothDensity {
 public:
  explicit SmoothDensity(const std::vector<double>& density) {
    const double floor = 1e-25 * *std::max_element(density.begin(), density.end());
    for (const double f : density) ln_density_.push_back(std::log(std::max(f, floor)));
    sum_.assign(density.size(), 0);
    for (std::size_t i = 0; i + 1 < density.size(); ++i) sum_[i + 1] = sum_[i] + integral(i, 1);
  }

  // Position (in cells) at which the integral reaches `share`.
  [[nodiscard]] double quantile(double share) const {
    const double target = share * sum_.back();
    const auto above = std::upper_bound(sum_.begin(), sum_.end() - 1, target);
    const auto i = static_cast<std::size_t>(above - sum_.begin()) - 1;
    double low = 0, high = 1;
    for (int k = 0; k < 40; ++k) {
      const double s = (low + high) / 2;
      (sum_[i] + integral(i, s) < target ? low : high) = s;
    }
    return static_cast<double>(i) + low;
  }

 private:
  // Integral over the first `part` of cell i.
  [[nodiscard]] double integral(std::size_t i, double part) const {
    const std::size_t first = std::clamp<std::size_t>(i, 1, ln_density_.size() - 3) - 1;
    const double* f = &ln_density_[first];
    const double offset = static_cast<double>(i - first);
    const double d1 = f[1] - f[0], d2 = f[2] - 2 * f[1] + f[0], d3 = f[3] - 3 * f[2] + 3 * f[1] - f[0];
    const auto density = [&](double s) {
      const double x = offset + s;  // Newton's form of the cubic through nodes 0..3
      return std::exp(f[0] + x * (d1 + (x - 1) * (d2 / 2 + (x - 2) * d3 / 6)));
    };
    return boost::math::quadrature::gauss<double, 7>::integrate(density, 0.0, part);
  }

  std::vector<double> ln_density_, sum_;
};

struct Quantiles {
  double median, low, high;       // in t
  double lower_edge, upper_edge;  // density at the ends of the window over its maximum
};

Quantiles quantiles(const DensityGrid& grid, const NodesAndWeights& rule, const ParameterBox<3>& window) {
  const std::vector<double> density = integrate(grid, rule).t;
  const SmoothDensity smooth(density);
  const double low = window.lower[place_t];
  const double step = (window.upper[place_t] - low) / static_cast<double>(grid.size.t - 1);
  const double highest = *std::max_element(density.begin(), density.end());
  return {low + step * smooth.quantile(0.5), low + step * smooth.quantile(0.025), low + step * smooth.quantile(0.975),
          density.front() / highest, density.back() / highest};
}

bool agree(const Quantiles& a, const Quantiles& b) {
  const double allowed = 1e-4 * (b.high - b.low);
  return std::abs(a.median - b.median) < allowed && std::abs(a.low - b.low) < allowed &&
         std::abs(a.high - b.high) < allowed;
}

}  // namespace

Posterior grid_posterior(const PooledCounts& counts, PsychometricForm form, std::vector<ScanNode> nodes,
                         std::optional<double> lapse) {
  ParameterBox<3> prior = search_box(lapse);
  prior.lower[place_t] = counts.first() - std::numbers::ln10;
  prior.upper[place_t] = counts.last() + std::numbers::ln10;
  for (ScanNode& node : nodes)
    node.place[place_t] = std::clamp(node.place[place_t], prior.lower[place_t], prior.upper[place_t]);
  const double blank = counts.blank_right * std::log(chance_level) + counts.blank_wrong * std::log1p(-chance_level);
  const Maximum<3> peak = mode(counts, form, nodes, prior);
  const ParameterBox<3> window = settled_window(counts, form, first_window(peak, nodes, prior, blank), prior);

  const LapseTables tables = lapse_tables(form, window.lower[place_lapse], window.upper[place_lapse], LapseRule::fine);
  // 15 slopes over a window of about +-6 standard deviations: trapezoidal steps of 0.9 are exact to 1e-9 for a normal
  // density; any other is refined until the quantiles agree.
  DensityGrid grid = evaluate(counts, tables, window, {49, 15}, {});
  Quantiles fine = quantiles(grid, tables.rule, window);
  constexpr std::size_t most_nodes = 769, most_slopes = 129;
  for (bool settled = false; !settled && grid.size.t < most_nodes;) {
    grid = evaluate(counts, tables, window, {2 * grid.size.t - 1, std::min(2 * grid.size.q - 1, most_slopes)}, grid);
    const Quantiles finer = quantiles(grid, tables.rule, window);
    settled = agree(fine, finer);
    fine = finer;
  }
  const auto at = [&](double t) { return counts.reference_size * std::exp(t); };
  const bool at_lower_edge = window.lower[place_t] <= prior.lower[place_t] && fine.lower_edge > 0.01;
  const bool at_upper_edge = window.upper[place_t] >= prior.upper[place_t] && fine.upper_edge > 0.01;
  return {at(fine.median), at(fine.low), at(fine.high), at_lower_edge || at_upper_edge};
}

}  // namespace todbench
