// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/psychometric/contrast_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "acquisition/base/try.h"

namespace todbench {
namespace {

double internal_of(const ContrastNoise& noise) {
  constexpr double of_hvs_1 = 0.07;
  return noise.internal_noise > 0 ? noise.internal_noise : of_hvs_1;
}

/// Standard error of ln threshold of a table: the proportions of about three sizes decide it.
double threshold_error(const ProportionTable& table, const TwinShape& shape) {
  double nearest = HUGE_VAL, error = 0;
  for (std::size_t i = 0; i < table.size_mrad.size(); ++i) {
    const double distance = std::abs(std::log(table.size_mrad[i]) - shape.ln_threshold());
    if (!(distance < nearest)) continue;
    nearest = distance;
    error = table.standard_error[i];
  }
  return error / shape.at(shape.ln_threshold()).derivative / std::numbers::sqrt3;
}

/// Cubic through four values (Lagrange).
template <typename Nodes>
double cubic(const Nodes& nodes, std::size_t first, std::size_t count, double u) {
  double sum = 0;
  for (std::size_t i = first; i < first + count; ++i) {
    double weight = 1;
    for (std::size_t j = first; j < first + count; ++j)
      if (j != i) weight *= (u - nodes[j].u) / (nodes[i].u - nodes[j].u);
    sum += weight * nodes[i].ln_threshold;
  }
  return sum;
}

/// Index of the node below u, at most the last but one.
template <typename Nodes>
std::size_t below(const Nodes& nodes, double u) {
  std::size_t i = 0;
  while (i + 2 < nodes.size() && nodes[i + 1].u < u) ++i;
  return i;
}

}  // namespace

double contrast_bend(const ContrastNoise& noise, double delta_t_k) {
  const double ratio = noise.noise_k / std::abs(delta_t_k) / internal_of(noise);
  return 0.5 * std::log1p(ratio * ratio) / std::log(5.0);
}

std::vector<double> contrasts_of_surface(const ContrastNoise& noise, double strongest_k, double weakest_k) {
  constexpr double widest_step = 0.2, least_step = 1e-3;
  const double from = contrast_bend(noise, strongest_k), to = contrast_bend(noise, weakest_k);
  if (!(to - from > least_step)) return {strongest_k, weakest_k};
  const int steps = std::max(3, static_cast<int>(std::ceil((to - from) / widest_step)));
  std::vector<double> out{strongest_k};
  for (int i = 1; i < steps; ++i) {
    const double u = from + (to - from) * i / steps;
    const double ratio = std::sqrt(std::expm1(2 * u * std::log(5.0)));
    out.push_back(std::copysign(noise.noise_k / (ratio * internal_of(noise)), strongest_k));
  }
  out.push_back(weakest_k);
  return out;
}

Result<ContrastSurface> ContrastSurface::of(std::span<const TableAtContrast> tables, const ContrastNoise& noise) {
  auto nodes = std::make_shared<std::vector<Node>>();
  for (const TableAtContrast& one : tables) {
    TODBENCH_TRY(auto shape, TwinShape::of(one.table));
    nodes->push_back({contrast_bend(noise, one.delta_t_k), shape.ln_threshold(), threshold_error(one.table, shape),
                      std::move(shape)});
  }
  std::ranges::sort(*nodes, {}, &Node::u);
  const auto same = std::ranges::adjacent_find(*nodes, [](const Node& a, const Node& b) { return !(a.u < b.u); });
  if (nodes->size() < 2 || same != nodes->end())
    return fail(ErrorCode::invalid_input, "function over contrast: at least two different contrasts are needed");
  ContrastSurface out;
  out.nodes_ = std::move(nodes);
  out.noise_ = noise;
  return out;
}

double ContrastSurface::ln_threshold(double delta_t_k) const {
  const auto& nodes = *nodes_;
  const double u = std::max(contrast_bend(noise_, delta_t_k), nodes.front().u);
  const std::size_t count = std::min<std::size_t>(4, nodes.size());
  const std::size_t first = std::min(below(nodes, u) - std::min<std::size_t>(below(nodes, u), 1), nodes.size() - count);
  return cubic(nodes, first, count, u);
}

double ContrastSurface::slope(double delta_t_k) const {
  constexpr double h = 0.01;
  return (ln_threshold(delta_t_k * std::exp(h)) - ln_threshold(delta_t_k * std::exp(-h))) / (2 * h);
}

TwinShape::Value ContrastSurface::at(double ln_size, double delta_t_k) const {
  const auto& nodes = *nodes_;
  const double u = contrast_bend(noise_, delta_t_k);
  const std::size_t i = below(nodes, u);
  const double share = std::clamp((u - nodes[i].u) / (nodes[i + 1].u - nodes[i].u), 0.0, 1.0);
  const double from_threshold = ln_size - ln_threshold(delta_t_k);
  const auto a = nodes[i].shape.at(nodes[i].ln_threshold + from_threshold);
  const auto b = nodes[i + 1].shape.at(nodes[i + 1].ln_threshold + from_threshold);
  return {(1 - share) * a.proportion + share * b.proportion, (1 - share) * a.derivative + share * b.derivative};
}

double ContrastSurface::standard_error(double delta_t_k) const {
  const double u = contrast_bend(noise_, delta_t_k);
  return std::ranges::min_element(*nodes_, {}, [u](const Node& node) { return std::abs(node.u - u); })->se;
}

}  // namespace todbench
