// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/contrast_lag.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "acquisition/base/distributions.h"
#include "acquisition/base/median.h"

namespace todbench {
namespace {

constexpr double tail = 0.01 / 3 / 2;  ///< of each end of each of three estimates
constexpr std::size_t least_presentations = 12;

/// A presentation with the contrasts of both kinds of triangles.
struct Shown {
  double large_k = 0, small_k = 0;
  double time_s = 0;
  double rate_k_per_s = 0;
  bool held = false, has_rate = false;
};

using SetUpShown = std::vector<Shown>;

std::vector<SetUpShown> by_set_up(std::span<const Presentation> presentations, double step_s) {
  std::vector<SetUpShown> out;
  const Presentation* before = nullptr;
  for (const Presentation& one : presentations) {
    const bool same =
        before != nullptr && before->set.plate == one.set.plate && before->set.mounting == one.set.mounting;
    if (!same) out.emplace_back();
    before = &one;
    if (!one.delta_t_k || !one.small_delta_t_k) continue;
    const double time_s = one.host_time_ns ? static_cast<double>(*one.host_time_ns) * 1e-9
                                           : static_cast<double>(one.presentation) * step_s;
    out.back().push_back({*one.delta_t_k, *one.small_delta_t_k, time_s, 0, one.set.wait == ContrastWait::held, false});
  }
  return out;
}

/// Rates between the neighbours of a presentation, unless a correction or another wait lies between them.
void add_rates(std::vector<SetUpShown>& set_ups) {
  std::vector<double> steps;
  for (const SetUpShown& shown : set_ups)
    for (std::size_t i = 1; i < shown.size(); ++i) steps.push_back(shown[i].time_s - shown[i - 1].time_s);
  if (steps.empty()) return;
  constexpr double most_steps = 2.5;
  const double most_s = most_steps * median(steps);
  for (SetUpShown& shown : set_ups) {
    for (std::size_t i = 1; i + 1 < shown.size(); ++i) {
      const Shown &a = shown[i - 1], &b = shown[i + 1];
      const bool near = shown[i].time_s - a.time_s <= most_s && b.time_s - shown[i].time_s <= most_s;
      if (a.held || shown[i].held || b.held || !near || !(b.time_s > a.time_s)) continue;
      shown[i].rate_k_per_s = (b.large_k - a.large_k) / (b.time_s - a.time_s);
      shown[i].has_rate = true;
    }
  }
}

struct Fit {
  Eigen::VectorXd value{};
  Eigen::MatrixXd covariance{};
  double degrees_of_freedom = 0;
};

/// Errors of both contrasts are a share of the contrast above ten times the smallest one, and constant below.
std::optional<Fit> fit_of(const SetUpShown& shown, bool directions_apart) {
  double smallest = HUGE_VAL;
  for (const Shown& one : shown) smallest = std::min(smallest, std::abs(one.large_k));
  std::vector<const Shown*> used;
  for (const Shown& one : shown)
    if (one.has_rate || (directions_apart && one.held)) used.push_back(&one);
  const Eigen::Index unknowns = directions_apart ? 4 : 3;
  const auto n = static_cast<Eigen::Index>(used.size());
  if (used.size() < least_presentations) return std::nullopt;
  Eigen::MatrixXd rows(n, unknowns);
  Eigen::VectorXd small(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Shown& one = *used[static_cast<std::size_t>(i)];
    const double weight = 1 / std::hypot(1, one.large_k / (10 * smallest));
    rows.row(i).setZero();
    rows(i, 0) = weight * one.large_k;
    rows(i, 1) = weight;
    const bool down = one.rate_k_per_s * one.large_k < 0;
    rows(i, directions_apart && !down ? 3 : 2) = -weight * one.rate_k_per_s;
    small(i) = weight * one.small_k;
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(rows);
  if (solver.rank() < unknowns) return std::nullopt;
  Fit fit{.value = solver.solve(small), .degrees_of_freedom = static_cast<double>(n - unknowns)};
  const double variance = (small - rows * fit.value).squaredNorm() / fit.degrees_of_freedom;
  fit.covariance = variance * (rows.transpose() * rows).inverse();
  return fit;
}

LagEstimate estimate_of(const Fit& fit, Eigen::Index which) {
  return {fit.value(which) / fit.value(0), std::sqrt(fit.covariance(which, which)) / std::abs(fit.value(0)),
          fit.degrees_of_freedom};
}

}  // namespace

double LagEstimate::chance_s() const {
  return distribution::quantile_above(tail, degrees_of_freedom) * standard_error_s;
}

bool LagEstimate::exceeds(double stated_s) const {
  return std::abs(lag_s) - chance_s() > stated_s;
}

std::optional<ContrastLag> contrast_lag(std::span<const Presentation> presentations, double step_s) {
  std::vector<SetUpShown> set_ups = by_set_up(presentations, step_s);
  add_rates(set_ups);
  ContrastLag out;
  std::vector<double> lags;
  for (const SetUpShown& shown : set_ups) {
    const auto fit = fit_of(shown, false);
    if (!fit) continue;
    lags.push_back(fit->value(2) / fit->value(0));
    const bool held = std::ranges::any_of(shown, [](const Shown& one) { return one.held; });
    if (out.down || !held) continue;
    if (const auto apart = fit_of(shown, true)) {
      out.down = estimate_of(*apart, 2);
      out.up = estimate_of(*apart, 3);
    }
  }
  if (lags.size() < 3) return std::nullopt;
  const auto n = static_cast<double>(lags.size());
  for (const double lag : lags) out.all.lag_s += lag / n;
  double squares = 0;
  for (const double lag : lags) squares += (lag - out.all.lag_s) * (lag - out.all.lag_s);
  out.all.standard_error_s = std::sqrt(squares / (n - 1) / n);
  out.all.degrees_of_freedom = n - 1;
  return out;
}

}  // namespace todbench
