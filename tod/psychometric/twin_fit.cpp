// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "acquisition/base/distributions.h"
#include "acquisition/base/try.h"
#include "tod/psychometric/clustered_variance.h"
#include "tod/psychometric/psychometric_model.h"
#include "tod/psychometric/twin_mean.h"
#include "tod/psychometric/twin_shape.h"

namespace todbench {
namespace {

/// All answers at one size.
struct PooledAnswers {
  double ln_size = 0, sum = 0, count = 0;
};

std::vector<PooledAnswers> pooled(std::span<const GradedAnswer> answers) {
  std::vector<PooledAnswers> rows;
  for (const GradedAnswer& answer : answers) {
    if (!(answer.size > 0)) continue;
    const double x = std::log(answer.size);
    auto row =
        std::find_if(rows.begin(), rows.end(), [x](const PooledAnswers& r) { return std::abs(r.ln_size - x) < 1e-9; });
    if (row == rows.end()) row = rows.insert(rows.end(), {x, 0, 0});
    row->sum += answer.probability_correct;
    row->count += 1;
  }
  return rows;
}

/// Fitted parameters, the size first.
using Searched = std::vector<std::size_t>;

Eigen::VectorXd gradient_of(const TwinMean::Value& mean, const Searched& searched) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(searched.size()));
  for (std::size_t k = 0; k < searched.size(); ++k) out(static_cast<Eigen::Index>(k)) = mean.gradient[searched[k]];
  return out;
}

double quasi_likelihood(const TwinShape& shape, const TwinPlace& place, std::span<const PooledAnswers> rows) {
  const TwinMean mean(shape, place);
  double sum = 0;
  for (const PooledAnswers& row : rows) {
    const double mu = mean.at(row.ln_size).value;
    sum += row.sum * std::log(mu) + (row.count - row.sum) * std::log1p(-mu);
  }
  return sum;
}

struct ScoreAndInformation {
  Eigen::VectorXd score;
  Eigen::MatrixXd information;
};

ScoreAndInformation expansion_at(const TwinShape& shape, const TwinPlace& place, const Searched& searched,
                                 std::span<const PooledAnswers> rows) {
  const auto n = static_cast<Eigen::Index>(searched.size());
  ScoreAndInformation out{Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(n, n)};
  const TwinMean means(shape, place);
  for (const PooledAnswers& row : rows) {
    const auto mean = means.at(row.ln_size);
    const double v = mean.value * (1 - mean.value);
    const Eigen::VectorXd g = gradient_of(mean, searched);
    out.score += (row.sum - row.count * mean.value) / v * g;
    out.information += row.count / v * g * g.transpose();
  }
  return out;
}

/// Fisher scoring with halved steps.
TwinPlace climb_from(const TwinShape& shape, TwinPlace place, const Searched& searched,
                     std::span<const PooledAnswers> rows) {
  const double largest_lapse = largest_twin_lapse(shape);
  double value = quasi_likelihood(shape, place, rows);
  for (int step = 0; step < 50; ++step) {
    const auto [score, information] = expansion_at(shape, place, searched, rows);
    const Eigen::LLT<Eigen::MatrixXd> factor(information);
    if (factor.info() != Eigen::Success) break;
    const Eigen::VectorXd move = factor.solve(score);
    double length = 1;
    bool better = false;
    for (int halving = 0; halving < 30 && !better; ++halving, length /= 2) {
      TwinPlace next = place;
      for (std::size_t k = 0; k < searched.size(); ++k)
        next[searched[k]] += length * move(static_cast<Eigen::Index>(k));
      next[twin_slope] = std::clamp(next[twin_slope], -1.5, 1.5);
      if (searched.back() == twin_lapse) next[twin_lapse] = std::clamp(next[twin_lapse], 0.0, largest_lapse);
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

/// A maximum, and the parameters that are inside their domain there.
struct TwinMaximum {
  TwinPlace place{};
  Searched searched;
};

/// Maximum over `searched` and a lapse from 0 on; 0 if the answers call for none.
TwinMaximum with_free_lapse(const TwinShape& shape, TwinPlace place, const Searched& searched,
                            std::span<const PooledAnswers> rows) {
  place[twin_lapse] = 0;
  const TwinMaximum without{climb_from(shape, place, searched, rows), searched};
  const double largest = largest_twin_lapse(shape);
  if (!(largest > 0) || !(expansion_at(shape, without.place, {twin_lapse}, rows).score(0) > 0)) return without;
  TwinMaximum with{without.place, searched};
  with.place[twin_lapse] = std::min(0.01, largest / 2);
  with.place = climb_from(shape, with.place, searched, rows);
  with.searched.push_back(twin_lapse);
  with.place = climb_from(shape, with.place, with.searched, rows);
  if (with.place[twin_lapse] >= largest) {
    // At the end of its domain it counts as fixed.
    with.searched.pop_back();
    with.place = climb_from(shape, with.place, with.searched, rows);
  }
  const bool better = quasi_likelihood(shape, with.place, rows) > quasi_likelihood(shape, without.place, rows);
  return better && with.place[twin_lapse] > 0 ? with : without;
}

AnswerScatter scatter_of(std::span<const GradedAnswer> answers) {
  const bool all_whole = std::ranges::all_of(answers, [](const GradedAnswer& answer) {
    return answer.probability_correct == 0 || answer.probability_correct == 1;
  });
  return all_whole ? AnswerScatter::binomial : AnswerScatter::estimated;
}

/// Variance of the parameter `which`, one of `searched`.
ClusteredVariance variance_of(const TwinShape& shape, const TwinMaximum& at, std::span<const GradedAnswer> answers,
                              std::size_t which) {
  const TwinMean means(shape, at.place);
  std::vector<AnswerScore> scores;
  for (const GradedAnswer& answer : answers) {
    if (!(answer.size > 0)) continue;
    const auto mean = means.at(std::log(answer.size));
    const double sd = std::sqrt(mean.value * (1 - mean.value));
    AnswerScore score{.direction = {},
                      .residual = (answer.probability_correct - mean.value) / sd,
                      .presentation = answer.presentation,
                      .place = answer.place,
                      .set_up = answer.set_up};
    for (std::size_t k = 0; k < at.searched.size(); ++k) score.direction[k] = mean.gradient[at.searched[k]] / sd;
    scores.push_back(score);
  }
  const auto place = std::ranges::find(at.searched, which) - at.searched.begin();
  return clustered_variance(scores, at.searched.size(), static_cast<std::size_t>(place), scatter_of(answers));
}

/// Significance level for a further parameter, and for a finding.
constexpr double asked_for = 0.01;

/// A further parameter at its estimate: its value in standard errors, and the limit by chance.
struct Further {
  TwinMaximum at;
  double t = 0, limit = 0;
};

std::optional<Further> further(const TwinShape& shape, const TwinMaximum& from, std::size_t parameter,
                               std::span<const GradedAnswer> answers, std::span<const PooledAnswers> rows) {
  Further out{.at = from};
  // After the size: a lapse stays the last one.
  out.at.searched.insert(out.at.searched.begin() + 1, parameter);
  out.at.place = climb_from(shape, from.place, out.at.searched, rows);
  const ClusteredVariance found = variance_of(shape, out.at, answers, parameter);
  if (!std::isfinite(found.variance) || !(found.variance > 0)) return std::nullopt;
  out.t = out.at.place[parameter] / std::sqrt(found.variance);
  out.limit = distribution::quantile_above(asked_for / 2, found.degrees_of_freedom);
  return out;
}

/// Variance of the threshold from the errors of the table: every node is shifted by its own, one after the other.
double variance_of_shape(const ProportionTable& table, const TwinMaximum& at, double ln_threshold,
                         std::span<const PooledAnswers> rows) {
  double variance = 0;
  for (std::size_t k = 0; k < table.size_mrad.size(); ++k) {
    ProportionTable moved = table;
    moved.proportion_correct[k] = std::clamp(moved.proportion_correct[k] + moved.standard_error[k], 0.0, 1.0);
    const auto shape = TwinShape::of(moved);
    if (!shape) continue;
    const TwinPlace there = climb_from(*shape, at.place, at.searched, rows);
    variance += std::pow(shape->ln_threshold() + there[twin_size] - ln_threshold, 2);
  }
  return variance;
}

/// The slope of the Weibull function with this derivative at 75 %.
double weibull_slope(PsychometricForm form, double lapse, double derivative) {
  const Link link = make_link(form, lapse);
  return derivative / (link.amplitude * link.kappa * std::exp(-link.kappa));
}

/// Deviance against one free proportion per size.
double deviance_of(const TwinShape& shape, const TwinPlace& place, std::span<const PooledAnswers> rows) {
  const TwinMean means(shape, place);
  const auto part = [](double found, double expected) { return found > 0 ? found * std::log(found / expected) : 0; };
  double sum = 0;
  for (const PooledAnswers& row : rows) {
    const double mu = means.at(row.ln_size).value;
    sum += part(row.sum, row.count * mu) + part(row.count - row.sum, row.count * (1 - mu));
  }
  return 2 * sum;
}

/// The fit at a maximum; fields other than the parameters are those of `like`.
PsychometricFit fit_at(const TwinShape& shape, const TwinMaximum& at, TwinShapeUse use,
                       std::span<const GradedAnswer> answers, std::span<const PooledAnswers> rows,
                       const PsychometricFit& like, PsychometricForm form) {
  const ClusteredVariance found = variance_of(shape, at, answers, twin_size);
  const double ln_threshold = shape.ln_threshold() + at.place[twin_size];
  const double of_shape = variance_of_shape(use.table, at, ln_threshold, rows);
  use.size_ratio = std::exp(at.place[twin_size]);
  use.slope_ratio = std::exp(at.place[twin_slope]);
  use.shape_se_ln_threshold = std::sqrt(of_shape);
  if (at.searched.back() == twin_lapse) {
    const ClusteredVariance of_lapse = variance_of(shape, at, answers, twin_lapse);
    if (std::isfinite(of_lapse.variance)) use.lapse_inflation = of_lapse.variance / of_lapse.independent;
  }

  PsychometricFit fit = like;
  fit.threshold = std::exp(ln_threshold);
  const auto [first, last] = std::ranges::minmax(rows, {}, &PooledAnswers::ln_size);
  fit.verdict = ln_threshold < first.ln_size || ln_threshold > last.ln_size ? FitVerdict::extrapolated : FitVerdict::ok;
  fit.lapse = at.place[twin_lapse];
  fit.slope = weibull_slope(form, fit.lapse, TwinMean(shape, at.place).at(ln_threshold).gradient[twin_size] * -1);
  fit.slope_at_cap = false;
  fit.posterior.reset();
  fit.log_likelihood = quasi_likelihood(shape, at.place, rows);
  fit.deviance.reset();
  fit.dispersion.reset();
  if (scatter_of(answers) == AnswerScatter::binomial)
    fit.deviance = deviance_of(shape, at.place, rows);
  else
    fit.dispersion = found.dispersion;
  fit.degrees_of_freedom = static_cast<int>(rows.size()) - static_cast<int>(at.searched.size());
  fit.interval = found.kind;
  fit.twin_shape = std::move(use);
  fit.ci95 = fit.ci90 = {};
  fit.se_ln_threshold.reset();
  if (!std::isfinite(found.variance)) return fit;
  const double variance = found.variance + of_shape;
  fit.se_ln_threshold = std::sqrt(found.independent);
  fit.variance_inflation = variance / found.independent;
  // The variance of the table is known from thousands of draws: only the other part has few degrees of freedom
  // (Satterthwaite).
  const double freedom = found.degrees_of_freedom * std::pow(variance / found.variance, 2);
  fit.clusters = freedom + 1;
  const auto interval = [&](double tail) {
    const double half = distribution::quantile_above(tail, freedom) * std::sqrt(variance);
    return Interval{std::exp(ln_threshold - half), std::exp(ln_threshold + half)};
  };
  fit.ci95 = interval(0.025);
  fit.ci90 = interval(0.05);
  return fit;
}

bool has_regular_maximum(const PsychometricFit& fit) {
  return (fit.verdict == FitVerdict::ok || fit.verdict == FitVerdict::extrapolated) && fit.threshold;
}

}  // namespace

Result<PsychometricFit> fit_twin_shape(std::span<const GradedAnswer> answers, const PsychometricFit& weibull,
                                       const ProportionTable& table, const FitOptions& options) {
  TODBENCH_TRY(const auto shape, TwinShape::of(table));
  const double lapse = options.fixed_lapse.value_or(0);
  if (!(lapse >= 0 && lapse <= max_free_lapse))
    return fail(ErrorCode::invalid_input, "the lapse rate must be from 0 to 0.1");
  if (lapse > 0 && lapse > largest_twin_lapse(shape))
    return fail(ErrorCode::invalid_input,
                "function of the twin: with this lapse rate, 75 % correct lies outside the sizes of its table");
  if (!has_regular_maximum(weibull)) return weibull;
  const std::vector<PooledAnswers> rows = pooled(answers);
  TwinMaximum at{.place = {std::log(*weibull.threshold) - shape.ln_threshold(), 0, 0, lapse}, .searched = {twin_size}};
  if (options.fixed_lapse)
    at.place = climb_from(shape, at.place, at.searched, rows);
  else
    at = with_free_lapse(shape, at.place, at.searched, rows);
  TwinShapeUse use;
  use.table = table;
  auto next = further(shape, at, twin_slope, answers, rows);
  if (next && std::abs(next->t) > next->limit) {
    use.slope_fitted = true;
    at = options.fixed_lapse ? next->at : with_free_lapse(shape, next->at.place, {twin_size, twin_slope}, rows);
    next = further(shape, at, twin_bend, answers, rows);
  }
  if (next) {
    use.departure = next->t;
    use.departure_limit = next->limit;
    use.departure_shift = next->at.place[twin_size] - at.place[twin_size];
  }
  return fit_at(shape, at, std::move(use), answers, rows, weibull, options.form);
}

Result<PsychometricFit> twin_fit_with_free_lapse(std::span<const GradedAnswer> answers, const PsychometricFit& fit,
                                                 PsychometricForm form) {
  if (!fit.twin_shape) return fail(ErrorCode::invalid_input, "function of the twin: the fit used another function");
  TODBENCH_TRY(const auto shape, TwinShape::of(fit.twin_shape->table));
  const std::vector<PooledAnswers> rows = pooled(answers);
  Searched searched{twin_size};
  if (fit.twin_shape->slope_fitted) searched.push_back(twin_slope);
  const TwinMaximum at = with_free_lapse(shape, twin_place(*fit.twin_shape, 0), searched, rows);
  TwinShapeUse use = *fit.twin_shape;
  use.departure = use.departure_limit = use.departure_shift = 0;
  return fit_at(shape, at, std::move(use), answers, rows, fit, form);
}

double twin_lapse_gain(const PsychometricFit& fit, const PsychometricFit& free_fit) {
  if (!fit.log_likelihood || !free_fit.log_likelihood || !free_fit.twin_shape || !(free_fit.lapse > fit.lapse))
    return 0;
  const double inflation = free_fit.twin_shape->lapse_inflation;
  return std::max(0.0, 2 * (*free_fit.log_likelihood - *fit.log_likelihood)) / inflation;
}

Result<ShapeEstimate> twin_shape_estimate(std::span<const GradedAnswer> answers, const ProportionTable& table,
                                          bool with_slope) {
  TODBENCH_TRY(const auto shape, TwinShape::of(table));
  const std::vector<PooledAnswers> rows = pooled(answers);
  Searched searched{twin_size};
  TwinPlace place = climb_from(shape, TwinPlace{}, searched, rows);
  if (with_slope) {
    searched.push_back(twin_slope);
    place = climb_from(shape, place, searched, rows);
  }
  const Eigen::MatrixXd information = expansion_at(shape, place, searched, rows).information;
  const Eigen::LLT<Eigen::MatrixXd> factor(information);
  if (factor.info() != Eigen::Success || !(information(0, 0) > 0))
    return fail(ErrorCode::invalid_input, "function of the twin: the answers do not determine the threshold");
  const Eigen::VectorXd inverse = factor.solve(Eigen::VectorXd::Unit(static_cast<Eigen::Index>(searched.size()), 0));
  ShapeEstimate out{
      .ln_threshold = shape.ln_threshold() + place[twin_size], .direction = {}, .weight = {}, .influence = {}};
  const TwinMean means(shape, place);
  for (const GradedAnswer& answer : answers) {
    if (!(answer.size > 0)) {
      for (auto* column : {&out.direction, &out.weight, &out.influence}) column->push_back(0);
      continue;
    }
    const auto mean = means.at(std::log(answer.size));
    const double variance = mean.value * (1 - mean.value);
    const double along = inverse.dot(gradient_of(mean, searched));
    out.direction.push_back(along / std::sqrt(variance) / inverse(0));
    out.weight.push_back(along / variance);
    out.influence.push_back(along * (answer.probability_correct - mean.value) / variance);
  }
  return out;
}

}  // namespace todbench
