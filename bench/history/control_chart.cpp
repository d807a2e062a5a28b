// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/history/control_chart.h"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>

#include "acquisition/base/distributions.h"
#include "acquisition/base/normal.h"

namespace todbench {
namespace {

constexpr double days_per_year = 365.25;

double below(double z) {
  return cdf(distribution::Normal(), z);
}

double density(double z) {
  return pdf(distribution::Normal(), z);
}

/// Abscissas and weights of a quadrature over [low, high].
struct Nodes {
  std::vector<double> at, weight;
};

Nodes nodes_between(double low, double high) {
  using Rule = boost::math::quadrature::gauss<double, 100>;
  Nodes nodes;
  for (std::size_t i = 0; i < Rule::abscissa().size(); ++i) {
    for (const double sign : {-1.0, 1.0}) {
      nodes.at.push_back(0.5 * (low + high) + 0.5 * sign * (high - low) * Rule::abscissa()[i]);
      nodes.weight.push_back(0.5 * (high - low) * Rule::weights()[i]);
    }
  }
  return nodes;
}

/// Returns the run length of a one-sided chart from 0: L(x) = 1 + L(0) P(k - x - shift) + integral of L(y) p(y - x + k
/// - shift).
double one_sided_cusum(double k, double h, double shift) {
  const Nodes nodes = nodes_between(0, h);
  const auto n = static_cast<Eigen::Index>(nodes.at.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(n + 1, n + 1);
  for (Eigen::Index i = 0; i <= n; ++i) {
    const double from = i == 0 ? 0 : nodes.at[static_cast<std::size_t>(i - 1)];
    a(i, 0) -= below(k - from - shift);
    for (Eigen::Index j = 1; j <= n; ++j) {
      const auto node = static_cast<std::size_t>(j - 1);
      a(i, j) -= nodes.weight[node] * density(nodes.at[node] - from + k - shift);
    }
  }
  return a.partialPivLu().solve(Eigen::VectorXd::Ones(n + 1))(0);
}

double scatter_of(const std::vector<ChartValue>& values) {
  double differences = 0, uncertainties = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) differences += std::pow(values[i].value - values[i - 1].value, 2);
    uncertainties += values[i].u * values[i].u;
  }
  const double variance =
      differences / (2 * static_cast<double>(values.size() - 1)) - uncertainties / static_cast<double>(values.size());
  return std::sqrt(std::max(0.0, variance));
}

}  // namespace

std::string_view to_string(CrossingKind kind) {
  switch (kind) {
    case CrossingKind::found:
      return "found";
    case CrossingKind::not_before:
      return "not_before";
    case CrossingKind::never:
      return "never";
  }
  return "";
}

std::optional<ControlChart> control_chart(const std::vector<ChartValue>& values, const ChartDesign& design) {
  const auto reference_count = design.reference ? 0 : static_cast<std::size_t>(std::max(1, design.reference_values));
  if (values.size() <= reference_count) return std::nullopt;
  ControlChart chart;
  chart.scatter = design.scatter ? *design.scatter : values.size() > 1 ? scatter_of(values) : 0;
  double weights = 0;
  for (std::size_t i = 0; i < reference_count; ++i) {
    const double variance = values[i].u * values[i].u + chart.scatter * chart.scatter;
    if (!(variance > 0)) return std::nullopt;
    weights += 1 / variance;
    chart.reference += values[i].value / variance;
  }
  if (design.reference) {
    chart.reference = *design.reference;
  } else {
    chart.reference /= weights;
    chart.reference_u = std::sqrt(1 / weights);
  }
  double ewma = 0, up = 0, down = 0;
  int step = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const ChartValue& value = values[i];
    const double sd = std::hypot(value.u, chart.scatter);
    if (!(sd > 0)) return std::nullopt;
    ChartPoint point{.days = value.days, .value = value.value, .u = value.u};
    point.z = (value.value - chart.reference) / sd;
    point.in_reference = i < reference_count;
    if (!point.in_reference) {
      ++step;
      ewma = design.lambda * point.z + (1 - design.lambda) * ewma;
      up = std::max(0.0, up + point.z - design.cusum_k);
      down = std::max(0.0, down - point.z - design.cusum_k);
      // The error of the reference shifts all later points equally.
      const double left = std::pow(1 - design.lambda, step);
      const double common = chart.reference_u / sd * (1 - left);
      point.ewma_limit =
          design.ewma_limit * std::sqrt(design.lambda / (2 - design.lambda) * (1 - left * left) + common * common);
      point.signal = std::abs(ewma) > point.ewma_limit || up > design.cusum_h || down > design.cusum_h;
    }
    point.ewma = ewma;
    point.cusum_up = up;
    point.cusum_down = down;
    chart.points.push_back(point);
  }
  return chart;
}

double ewma_run_length(double lambda, double limit, double shift) {
  const double h = limit * std::sqrt(lambda / (2 - lambda));
  const Nodes nodes = nodes_between(-h, h);
  const auto n = static_cast<Eigen::Index>(nodes.at.size());
  const auto kernel = [&](double from, std::size_t node) {
    return nodes.weight[node] / lambda * density((nodes.at[node] - (1 - lambda) * from) / lambda - shift);
  };
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j)
      a(i, j) -= kernel(nodes.at[static_cast<std::size_t>(i)], static_cast<std::size_t>(j));
  }
  const Eigen::VectorXd lengths = a.partialPivLu().solve(Eigen::VectorXd::Ones(n));
  double from_zero = 1;
  for (Eigen::Index j = 0; j < n; ++j) from_zero += kernel(0, static_cast<std::size_t>(j)) * lengths(j);
  return from_zero;
}

double cusum_run_length(double k, double h, double shift) {
  return 1 / (1 / one_sided_cusum(k, h, shift) + 1 / one_sided_cusum(k, h, -shift));
}

std::optional<LimitCrossing> crossing(const std::vector<ChartValue>& values, double scatter, double limit) {
  if (values.size() < 3) return std::nullopt;
  double w = 0, t_mean = 0, x_mean = 0;
  for (const ChartValue& value : values) {
    const double variance = value.u * value.u + scatter * scatter;
    if (!(variance > 0)) return std::nullopt;
    w += 1 / variance;
    t_mean += value.days / variance;
    x_mean += value.value / variance;
  }
  t_mean /= w;
  x_mean /= w;
  double stt = 0, stx = 0;
  for (const ChartValue& value : values) {
    const double weight = 1 / (value.u * value.u + scatter * scatter);
    stt += weight * std::pow(value.days - t_mean, 2);
    stx += weight * (value.days - t_mean) * (value.value - x_mean);
  }
  if (!(stt > 0)) return std::nullopt;
  const double b = stx / stt, var_b = 1 / stt, d = x_mean - limit, now = values.back().days;
  LimitCrossing out{.slope_per_year = b * days_per_year, .slope_u_per_year = std::sqrt(var_b) * days_per_year};
  const double best = t_mean - d / b;
  if (b != 0 && best > now) out.best_days = best;
  // A s^2 + 2 B s + C <= 0 with s = t - t_mean.
  const double a2 = b * b - normal_z95 * normal_z95 * var_b, b2 = d * b, c2 = d * d - normal_z95 * normal_z95 / w;
  const double discriminant = b2 * b2 - a2 * c2;
  if (a2 > 0) {
    // Significant slope: between the roots.
    if (discriminant < 0) return out;
    const double low = t_mean + (-b2 - std::sqrt(discriminant)) / a2,
                 high = t_mean + (-b2 + std::sqrt(discriminant)) / a2;
    if (high < now) return out;
    out.kind = CrossingKind::found;
    out.earliest_days = std::max(low, now);
    out.latest_days = high;
    return out;
  }
  // Slope not significant: all times, or all outside the roots.
  out.kind = CrossingKind::not_before;
  if (a2 == 0 || discriminant < 0) {
    out.earliest_days = now;
    return out;
  }
  const double root = std::sqrt(discriminant);
  const double r1 = t_mean + (-b2 + root) / a2,
               r2 = t_mean + (-b2 - root) / a2;  // r1 < r2 for a2 < 0
  const double later = std::max(r1, r2), earlier = std::min(r1, r2);
  out.earliest_days = now <= earlier ? now : std::max(now, later);
  return out;
}

}  // namespace todbench
