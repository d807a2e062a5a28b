// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/psychometric/twin_shape.h"

// pchip.hpp calls isnan() without a namespace.
#include <math.h>  // NOLINT(modernize-deprecated-headers)

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/interpolators/pchip.hpp>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/base/try.h"
#include "tod/psychometric/psychometric_model.h"
#include "tod/psychometric/twin_mean.h"

namespace todbench {
namespace {

constexpr std::size_t least_nodes = 5;
/// Proportions nearer to chance or 1 than this many standard errors are not distinguished from them.
constexpr double told_apart = 3;
/// Distance of fitted proportions from 1: one wrong answer in ten thousand may be a slip.
constexpr double least_wrong = 1e-4;

double transformed(double p) {
  return std::log((p - chance_level) / (1 - p));
}

struct Node {
  double x = 0;       ///< ln size
  double y = 0;       ///< transformed proportion
  double weight = 0;  ///< inverse variance of y
};

Result<std::vector<Node>> nodes_of(const ProportionTable& table) {
  const std::size_t n = table.size_mrad.size();
  if (table.proportion_correct.size() != n || table.standard_error.size() != n)
    return fail(ErrorCode::invalid_input, "function of the twin: the columns of its table differ in length");
  std::vector<Node> nodes;
  for (std::size_t k = 0; k < n; ++k) {
    const double size = table.size_mrad[k], p = table.proportion_correct[k], se = table.standard_error[k];
    const bool rising = k == 0 ? size > 0 : size > table.size_mrad[k - 1];
    if (!std::isfinite(size) || !rising || !(p >= 0 && p <= 1) || !(se >= 0 && std::isfinite(se)))
      return fail(ErrorCode::invalid_input,
                  "function of the twin: row " + std::to_string(k + 1) +
                      ": sizes must increase, proportions must be from 0 to 1 and their errors must be finite");
    const double margin = std::max(told_apart * se, least_wrong);
    if (p < chance_level + margin || p > 1 - margin) continue;
    const double slope = 1 / (p - chance_level) + 1 / (1 - p);
    nodes.push_back({std::log(size), transformed(p), 1 / std::pow(std::max(se, 1e-6) * slope, 2)});
  }
  if (nodes.size() < least_nodes)
    return fail(ErrorCode::invalid_input,
                "function of the twin: fewer than five sizes lie between chance and certainty");
  return nodes;
}

/// The weighted parabola through the neighbours of a node, at the node.
double smoothed(const std::vector<Node>& nodes, std::size_t middle) {
  constexpr std::size_t reach = 3;
  const std::size_t first = middle > reach ? middle - reach : 0, last = std::min(nodes.size() - 1, middle + reach);
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  const double span = 1.001 * std::max(nodes[last].x - nodes[middle].x, nodes[middle].x - nodes[first].x);
  for (std::size_t k = first; k <= last; ++k) {
    const double d = nodes[k].x - nodes[middle].x;
    // Tricube (Cleveland 1979).
    const double weight = nodes[k].weight * std::pow(1 - std::pow(std::abs(d) / span, 3), 3);
    const Eigen::Vector3d row(1, d, d * d);
    normal += weight * row * row.transpose();
    right += weight * nodes[k].y * row;
  }
  return normal.ldlt().solve(right)(0);
}

/// Rising at least slightly: neighbours that fall share their mean (pool adjacent violators).
std::vector<double> made_rising(const std::vector<double>& values) {
  std::vector<std::pair<double, std::size_t>> blocks;  // mean, count
  for (const double value : values) {
    blocks.emplace_back(value, 1);
    while (blocks.size() > 1 && blocks[blocks.size() - 2].first >= blocks.back().first) {
      const auto [mean, count] = blocks.back();
      blocks.pop_back();
      auto& before = blocks.back();
      const double all = static_cast<double>(before.second + count);
      before = {(before.first * static_cast<double>(before.second) + mean * static_cast<double>(count)) / all,
                before.second + count};
    }
  }
  std::vector<double> out;
  for (const auto& [mean, count] : blocks)
    for (std::size_t k = 0; k < count; ++k) out.push_back(mean + 1e-9 * static_cast<double>(out.size()));
  return out;
}

}  // namespace

struct TwinShape::Curve {
  double first = 0, last = 0;  ///< ln sizes of the outermost nodes
  double y_first = 0, y_last = 0, slope_first = 0, slope_last = 0;
  std::optional<boost::math::interpolators::pchip<std::vector<double>>> between;

  /// Transformed proportion and its derivative.
  [[nodiscard]] std::pair<double, double> at(double x) const {
    if (x <= first) return {y_first + slope_first * (x - first), slope_first};
    if (x >= last) return {y_last + slope_last * (x - last), slope_last};
    return {(*between)(x), between->prime(x)};
  }
};

Result<TwinShape> TwinShape::of(const ProportionTable& table) {
  TODBENCH_TRY(const auto nodes, nodes_of(table));
  std::vector<double> xs, ys;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    xs.push_back(nodes[k].x);
    ys.push_back(smoothed(nodes, k));
  }
  ys = made_rising(ys);
  const double at_75 = transformed(0.75);
  if (!(ys.front() < at_75 && ys.back() > at_75))
    return fail(ErrorCode::invalid_input, "function of the twin: 75 % correct lies outside the sizes of its table");
  auto curve = std::make_shared<Curve>();
  const std::size_t n = xs.size();
  curve->first = xs.front();
  curve->last = xs.back();
  curve->y_first = ys.front();
  curve->y_last = ys.back();
  // Over two intervals, because a single one is noisy.
  curve->slope_first = (ys[2] - ys[0]) / (xs[2] - xs[0]);
  curve->slope_last = (ys[n - 1] - ys[n - 3]) / (xs[n - 1] - xs[n - 3]);
  curve->between.emplace(std::move(xs), std::move(ys));
  TwinShape shape;
  shape.curve_ = std::move(curve);
  shape.ln_threshold_ = shape.ln_size_at(0.75);
  return shape;
}

double TwinShape::ln_size_at(double proportion) const {
  const double y = transformed(proportion);
  double low = curve_->first, high = curve_->last;
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (curve_->at(middle).first < y ? low : high) = middle;
  }
  return (low + high) / 2;
}

double TwinShape::largest_proportion() const {
  return at(curve_->last).proportion;
}

TwinShape::Value TwinShape::at(double ln_size) const {
  const auto [y, dy] = curve_->at(ln_size);
  // P = 1/4 + 3/4 / (1 + e^-y), kept away from its ends.
  const double rise = 1 / (1 + std::exp(-std::clamp(y, -40.0, 40.0)));
  const double p = chance_level + 0.75 * rise;
  if (p > 1 - least_wrong) return {1 - least_wrong, 0};
  return {p, 0.75 * rise * (1 - rise) * dy};
}

double twin_proportion(const TwinShape& shape, const TwinShapeUse& use, double lapse, double ln_size) {
  return TwinMean(shape, twin_place(use, lapse)).at(ln_size).value;
}

TwinPlace twin_place(const TwinShapeUse& use, double lapse) {
  TwinPlace place{};
  place[twin_size] = std::log(use.size_ratio);
  place[twin_slope] = std::log(use.slope_ratio);
  place[twin_lapse] = lapse;
  return place;
}

double largest_twin_lapse(const TwinShape& shape) {
  // 1/4 + 1/2 / r, the proportion of the twin that lapses turn into 75 %, must be in its table.
  const double least_share = 0.5 / (shape.largest_proportion() - chance_level);
  return std::clamp(0.75 * (1 - least_share), 0.0, max_free_lapse);
}

TwinMean::TwinMean(const TwinShape& shape, const TwinPlace& place)
    : shape_(shape), place_(place), share_(1 - place[twin_lapse] / (1 - chance_level)), centre_(shape.ln_threshold()) {
  if (!(place[twin_lapse] > 0)) {
    // d centre / d lapse at 0: (2/3) / F'(c).
    d_centre_ = 2.0 / 3 / shape.at(centre_).derivative;
    return;
  }
  centre_ = shape.ln_size_at(chance_level + 0.5 / share_);
  d_centre_ = 0.5 / (share_ * share_) / (1 - chance_level) / shape.at(centre_).derivative;
}

TwinMean::Value TwinMean::at(double ln_size) const {
  const double d = ln_size - shape_.ln_threshold() - place_[twin_size], slope = std::exp(place_[twin_slope]);
  const double bend = place_[twin_bend];
  const auto at = shape_.at(centre_ + slope * d + bend * d * d);
  const double rise = share_ * at.derivative;
  Value out{.value = chance_level + share_ * (at.proportion - chance_level), .gradient = {}};
  out.gradient[twin_size] = -rise * (slope + 2 * bend * d);
  out.gradient[twin_slope] = rise * slope * d;
  out.gradient[twin_bend] = rise * d * d;
  out.gradient[twin_lapse] = rise * d_centre_ - (at.proportion - chance_level) / (1 - chance_level);
  return out;
}

}  // namespace todbench
