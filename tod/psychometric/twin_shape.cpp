#include "tod/psychometric/twin_shape.h"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/interpolators/pchip.hpp>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tod/psychometric/clustered_variance.h"
#include "tod/psychometric/psychometric_model.h"

namespace todbench {
namespace {

constexpr std::size_t least_nodes = 5;
/// Proportions nearer to chance or 1 than so many standard errors are not told from them.
constexpr double told_apart = 3;
/// Fitted proportions stay so far from 1: one wrong answer in ten thousand is a slip, not a proof.
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
    return fail(ErrorCode::invalid_input, "twin shape: the columns of the table differ in length");
  std::vector<Node> nodes;
  for (std::size_t k = 0; k < n; ++k) {
    const double size = table.size_mrad[k], p = table.proportion_correct[k], se = table.standard_error[k];
    const bool rising = k == 0 ? size > 0 : size > table.size_mrad[k - 1];
    if (!std::isfinite(size) || !rising || !(p >= 0 && p <= 1) || !(se >= 0 && std::isfinite(se)))
      return fail(ErrorCode::invalid_input,
                  "twin shape: row " + std::to_string(k + 1) +
                      ": sizes must rise, proportions be from 0 to 1 and their errors finite");
    const double margin = std::max(told_apart * se, least_wrong);
    if (p < chance_level + margin || p > 1 - margin) continue;
    const double slope = 1 / (p - chance_level) + 1 / (1 - p);
    nodes.push_back({std::log(size), transformed(p), 1 / std::pow(std::max(se, 1e-6) * slope, 2)});
  }
  if (nodes.size() < least_nodes)
    return fail(ErrorCode::invalid_input, "twin shape: fewer than five sizes between chance and certainty");
  return nodes;
}

/// The parabola through the neighbours of a node, weighted, at the node.
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

/// Rising by at least a little: neighbours that fall share their mean (pool adjacent violators).
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
  const auto nodes = nodes_of(table);
  if (!nodes) return tl::unexpected(nodes.error());
  std::vector<double> xs, ys;
  for (std::size_t k = 0; k < nodes->size(); ++k) {
    xs.push_back((*nodes)[k].x);
    ys.push_back(smoothed(*nodes, k));
  }
  ys = made_rising(ys);
  const double at_75 = transformed(0.75);
  if (!(ys.front() < at_75 && ys.back() > at_75))
    return fail(ErrorCode::invalid_input, "twin shape: 75 % lies beyond the sizes of the table");
  auto curve = std::make_shared<Curve>();
  const std::size_t n = xs.size();
  curve->first = xs.front();
  curve->last = xs.back();
  curve->y_first = ys.front();
  curve->y_last = ys.back();
  // Over two intervals: one alone is noise.
  curve->slope_first = (ys[2] - ys[0]) / (xs[2] - xs[0]);
  curve->slope_last = (ys[n - 1] - ys[n - 3]) / (xs[n - 1] - xs[n - 3]);
  double low = xs.front(), high = xs.back();
  curve->between.emplace(std::move(xs), std::move(ys));
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (curve->at(middle).first < at_75 ? low : high) = middle;
  }
  TwinShape shape;
  shape.curve_ = std::move(curve);
  shape.ln_threshold_ = (low + high) / 2;
  return shape;
}

TwinShape::Value TwinShape::at(double ln_size) const {
  const auto [y, dy] = curve_->at(ln_size);
  // P = 1/4 + 3/4 / (1 + e^-y), kept off its ends.
  const double rise = 1 / (1 + std::exp(-std::clamp(y, -40.0, 40.0)));
  const double p = chance_level + 0.75 * rise;
  if (p > 1 - least_wrong) return {1 - least_wrong, 0};
  return {p, 0.75 * rise * (1 - rise) * dy};
}

double twin_ln_size(const TwinShape& shape, const TwinShapeUse& use, double ln_size) {
  const double middle = shape.ln_threshold() + std::log(use.size_ratio);
  return shape.ln_threshold() + use.slope_ratio * (ln_size - middle);
}

namespace {

/// All answers at one size.
struct Pooled {
  double ln_size = 0, sum = 0, count = 0;
};

std::vector<Pooled> pooled(std::span<const GradedAnswer> answers) {
  std::vector<Pooled> rows;
  for (const GradedAnswer& answer : answers) {
    if (!(answer.size > 0)) continue;
    const double x = std::log(answer.size);
    auto row = std::find_if(rows.begin(), rows.end(), [x](const Pooled& r) { return std::abs(r.ln_size - x) < 1e-9; });
    if (row == rows.end()) row = rows.insert(rows.end(), {x, 0, 0});
    row->sum += answer.probability_correct;
    row->count += 1;
  }
  return rows;
}

/// Parameters: ln size ratio, ln slope ratio, bend (per squared unit of ln size from the threshold).
using Place = std::array<double, 3>;

struct Mean {
  double value = 0;
  std::array<double, 3> gradient{};
};

Mean mean_at(const TwinShape& shape, const Place& place, double ln_size) {
  const double d = ln_size - shape.ln_threshold() - place[0], slope = std::exp(place[1]);
  const double bend = place[2] * d * d;
  const auto at = shape.at(shape.ln_threshold() + slope * d + bend);
  return {at.proportion,
          {-at.derivative * (slope + 2 * place[2] * d), at.derivative * slope * d, at.derivative * d * d}};
}

double quasi_likelihood(const TwinShape& shape, const Place& place, std::span<const Pooled> rows) {
  double sum = 0;
  for (const Pooled& row : rows) {
    const double mu = mean_at(shape, place, row.ln_size).value;
    sum += row.sum * std::log(mu) + (row.count - row.sum) * std::log1p(-mu);
  }
  return sum;
}

/// Fisher scoring with halved steps, over the first `parameters`.
Place climb_from(const TwinShape& shape, Place place, Eigen::Index parameters, std::span<const Pooled> rows) {
  double value = quasi_likelihood(shape, place, rows);
  for (int step = 0; step < 50; ++step) {
    Eigen::VectorXd score = Eigen::VectorXd::Zero(parameters);
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(parameters, parameters);
    for (const Pooled& row : rows) {
      const Mean mean = mean_at(shape, place, row.ln_size);
      const double v = mean.value * (1 - mean.value);
      const Eigen::VectorXd g = Eigen::Map<const Eigen::VectorXd>(mean.gradient.data(), parameters);
      score += (row.sum - row.count * mean.value) / v * g;
      information += row.count / v * g * g.transpose();
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(information);
    if (factor.info() != Eigen::Success) break;
    const Eigen::VectorXd move = factor.solve(score);
    double length = 1;
    bool better = false;
    for (int halving = 0; halving < 30 && !better; ++halving, length /= 2) {
      Place next = place;
      for (Eigen::Index k = 0; k < parameters; ++k) next[static_cast<std::size_t>(k)] += length * move(k);
      next[1] = std::clamp(next[1], -1.5, 1.5);
      const double there = quasi_likelihood(shape, next, rows);
      if (!(there > value)) continue;
      better = true;
      place = next;
      value = there;
    }
    if (!better || move.lpNorm<Eigen::Infinity>() * length < 1e-12) break;
  }
  return place;
}

ClusteredVariance variance_of(const TwinShape& shape, const Place& place, std::span<const GradedAnswer> answers,
                              std::size_t parameters, std::size_t which) {
  std::vector<AnswerScore> scores;
  for (const GradedAnswer& answer : answers) {
    if (!(answer.size > 0)) continue;
    const Mean mean = mean_at(shape, place, std::log(answer.size));
    const double sd = std::sqrt(mean.value * (1 - mean.value));
    AnswerScore score{.direction = {},
                      .residual = (answer.probability_correct - mean.value) / sd,
                      .presentation = answer.presentation,
                      .place = answer.place,
                      .set_up = answer.set_up};
    for (std::size_t k = 0; k < parameters; ++k) score.direction[k] = mean.gradient[k] / sd;
    scores.push_back(score);
  }
  return clustered_variance(scores, parameters, which);
}

double t_quantile(double tail, double degrees_of_freedom) {
  return boost::math::quantile(boost::math::complement(boost::math::students_t(degrees_of_freedom), tail));
}

/// Probability at which a further parameter is taken in, or is a finding.
constexpr double asked_for = 0.01;

/// A further parameter at its estimate: how many standard errors from nothing, and how many chance allows.
struct Further {
  Place place{};
  double t = 0, limit = 0;
};

std::optional<Further> further(const TwinShape& shape, const Place& from, std::size_t parameters,
                               std::span<const GradedAnswer> answers, std::span<const Pooled> rows) {
  Further out;
  out.place = climb_from(shape, from, static_cast<Eigen::Index>(parameters), rows);
  const ClusteredVariance found = variance_of(shape, out.place, answers, parameters, parameters - 1);
  if (!std::isfinite(found.variance) || !(found.variance > 0)) return std::nullopt;
  out.t = out.place[parameters - 1] / std::sqrt(found.variance);
  out.limit = t_quantile(asked_for / 2, found.degrees_of_freedom);
  return out;
}

/// What the errors of the table do to the threshold: every node moved by its own, one after the other.
double variance_of_shape(const ProportionTable& table, const Place& place, std::size_t parameters, double ln_threshold,
                         std::span<const Pooled> rows) {
  double variance = 0;
  for (std::size_t k = 0; k < table.size_mrad.size(); ++k) {
    ProportionTable moved = table;
    moved.proportion_correct[k] = std::clamp(moved.proportion_correct[k] + moved.standard_error[k], 0.0, 1.0);
    const auto shape = TwinShape::of(moved);
    if (!shape) continue;
    const Place there = climb_from(*shape, place, static_cast<Eigen::Index>(parameters), rows);
    variance += std::pow(shape->ln_threshold() + there[0] - ln_threshold, 2);
  }
  return variance;
}

/// The slope of the Weibull function with this derivative at 75 %.
double weibull_slope(PsychometricForm form, double derivative) {
  const double z = make_link(form, 0).kappa;
  return derivative / (0.75 * z * std::exp(-z));
}

}  // namespace

Result<PsychometricFit> fit_twin_shape(std::span<const GradedAnswer> answers, const PsychometricFit& weibull,
                                       const ProportionTable& table, const FitOptions& options) {
  if (options.fixed_lapse != 0.0)
    return fail(ErrorCode::invalid_input, "the function of the twin has no lapse: the lapse must be 0");
  const auto shape = TwinShape::of(table);
  if (!shape) return tl::unexpected(shape.error());
  if ((weibull.verdict != FitVerdict::ok && weibull.verdict != FitVerdict::extrapolated) || !weibull.threshold)
    return weibull;
  const std::vector<Pooled> rows = pooled(answers);
  Place place{std::log(*weibull.threshold) - shape->ln_threshold(), 0, 0};
  place = climb_from(*shape, place, 1, rows);
  TwinShapeUse use;
  use.table = table;
  std::size_t parameters = 1;
  auto next = further(*shape, place, 2, answers, rows);
  if (next && std::abs(next->t) > next->limit) {
    use.slope_fitted = true;
    parameters = 2;
    place = next->place;
    next = further(*shape, place, 3, answers, rows);
  }
  if (next) {
    use.departure = next->t;
    use.departure_limit = next->limit;
    use.departure_shift = next->place[0] - place[0];
  }
  const ClusteredVariance found = variance_of(*shape, place, answers, parameters, 0);
  const double ln_threshold = shape->ln_threshold() + place[0];
  const double of_shape = variance_of_shape(table, place, parameters, ln_threshold, rows);
  use.size_ratio = std::exp(place[0]);
  use.slope_ratio = std::exp(place[1]);
  use.shape_se_ln_threshold = std::sqrt(of_shape);

  PsychometricFit fit = weibull;
  fit.threshold = std::exp(ln_threshold);
  const auto [first, last] = std::ranges::minmax(rows, {}, &Pooled::ln_size);
  fit.verdict = ln_threshold < first.ln_size || ln_threshold > last.ln_size ? FitVerdict::extrapolated : FitVerdict::ok;
  fit.slope = weibull_slope(options.form, use.slope_ratio * shape->at(shape->ln_threshold()).derivative);
  fit.slope_at_cap = false;
  fit.posterior.reset();
  fit.log_likelihood = quasi_likelihood(*shape, place, rows);
  fit.deviance.reset();
  fit.degrees_of_freedom = static_cast<int>(rows.size()) - static_cast<int>(parameters);
  fit.interval = found.kind;
  fit.dispersion = found.dispersion;
  fit.twin_shape = std::move(use);
  fit.ci95 = fit.ci90 = {};
  fit.se_ln_threshold.reset();
  if (!std::isfinite(found.variance)) return fit;
  const double variance = found.variance + of_shape;
  fit.se_ln_threshold = std::sqrt(found.independent);
  fit.variance_inflation = variance / found.independent;
  // The part of the table is known from thousands of draws: only the other part has few degrees of freedom
  // (Satterthwaite).
  const double freedom = found.degrees_of_freedom * std::pow(variance / found.variance, 2);
  fit.clusters = freedom + 1;
  const auto interval = [&](double tail) {
    const double half = t_quantile(tail, freedom) * std::sqrt(variance);
    return Interval{std::exp(ln_threshold - half), std::exp(ln_threshold + half)};
  };
  fit.ci95 = interval(0.025);
  fit.ci90 = interval(0.05);
  return fit;
}

Result<ShapeEstimate> twin_shape_estimate(std::span<const GradedAnswer> answers, const ProportionTable& table,
                                          bool with_slope) {
  const auto shape = TwinShape::of(table);
  if (!shape) return tl::unexpected(shape.error());
  const std::vector<Pooled> rows = pooled(answers);
  const Eigen::Index parameters = with_slope ? 2 : 1;
  const Place place = climb_from(*shape, climb_from(*shape, {0, 0, 0}, 1, rows), parameters, rows);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(parameters, parameters);
  for (const Pooled& row : rows) {
    const Mean mean = mean_at(*shape, place, row.ln_size);
    const Eigen::VectorXd g = Eigen::Map<const Eigen::VectorXd>(mean.gradient.data(), parameters);
    information += row.count / (mean.value * (1 - mean.value)) * g * g.transpose();
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(information);
  if (factor.info() != Eigen::Success || !(information(0, 0) > 0))
    return fail(ErrorCode::invalid_input, "twin shape: the answers say nothing about the threshold");
  const Eigen::VectorXd inverse = factor.solve(Eigen::VectorXd::Unit(parameters, 0));
  ShapeEstimate out{.ln_threshold = shape->ln_threshold() + place[0], .direction = {}, .weight = {}, .influence = {}};
  for (const GradedAnswer& answer : answers) {
    if (!(answer.size > 0)) {
      for (auto* column : {&out.direction, &out.weight, &out.influence}) column->push_back(0);
      continue;
    }
    const Mean mean = mean_at(*shape, place, std::log(answer.size));
    const double variance = mean.value * (1 - mean.value);
    const double along = inverse.dot(Eigen::Map<const Eigen::VectorXd>(mean.gradient.data(), parameters));
    out.direction.push_back(along / std::sqrt(variance) / inverse(0));
    out.weight.push_back(along / variance);
    out.influence.push_back(along * (answer.probability_correct - mean.value) / variance);
  }
  return out;
}

}  // namespace todbench
