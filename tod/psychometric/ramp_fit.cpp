// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/psychometric/ramp_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "acquisition/base/distributions.h"
#include "acquisition/base/try.h"

namespace todbench {
namespace {

double dot(const std::array<double, most_parameters>& a, const std::array<double, most_parameters>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < most_parameters; ++k) sum += a[k] * b[k];
  return sum;
}

}  // namespace

bool RampDifference::beyond() const {
  return std::abs(ln_up_over_down) > limit;
}

std::array<double, most_parameters> RampFit::row(double u, RampDirection direction, double centre) const {
  std::array<double, most_parameters> out{};
  double power = 1;
  for (std::size_t k = 0; k < powers_; ++k, power *= u - centre) out[k] = power;
  if (parameters_ > powers_) out[powers_] = direction == RampDirection::up ? 0.5 : -0.5;
  return out;
}

/// Fisher scoring. The slope of a surface jumps at the ends of its tables. If a jump lies at the maximum, whole steps
/// go to and fro over it without end. A step back that is not much shorter than the last one is therefore halved, with
/// all later ones, and a maximum that is located to a thousandth of its standard error counts as found.
Result<void> RampFit::climb(Directions directions) {
  parameters_ = powers_ + (directions == Directions::apart ? 1 : 0);
  const auto n = static_cast<Eigen::Index>(parameters_);
  constexpr int most_steps = 50;
  constexpr double longest = 0.2, precise = 1e-9, precise_in_errors = 1e-3, singular = 1e-12;
  double share = 1, in_errors = 0;
  Eigen::VectorXd last = Eigen::VectorXd::Zero(n);
  for (int step = 0; step < most_steps; ++step) {
    Eigen::VectorXd score = Eigen::VectorXd::Zero(n);
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t i = 0; i < answers_.size(); ++i) {
      const auto basis = row(u_[i], answers_[i].direction, 0);
      const auto mean = surface_.at(std::log(answers_[i].answer.size) - dot(basis, value_), answers_[i].delta_t_k);
      const double v = mean.proportion * (1 - mean.proportion);
      const Eigen::Map<const Eigen::VectorXd> x(basis.data(), n);
      score -= mean.derivative * (answers_[i].answer.probability_correct - mean.proportion) / v * x;
      information += mean.derivative * mean.derivative / v * x * x.transpose();
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(information);
    if (factor.info() != Eigen::Success || factor.rcond() < singular)
      return fail(ErrorCode::invalid_input, "fit over contrast: the answers do not determine the curve");
    Eigen::VectorXd change = share * factor.solve(score);
    if (change.dot(information * last) < -0.5 * last.dot(information * last)) {
      change /= 2;
      share /= 2;
    }
    const double largest = change.lpNorm<Eigen::Infinity>();
    if (!std::isfinite(largest))
      return fail(ErrorCode::invalid_input, "fit over contrast: the answers do not determine the curve");
    if (largest > longest) change *= longest / largest;
    for (Eigen::Index k = 0; k < n; ++k) value_[static_cast<std::size_t>(k)] += change(k);
    if (largest < precise) return {};
    in_errors = std::sqrt(change.dot(information * change));
    last = change;
  }
  if (in_errors < precise_in_errors) return {};
  return fail(ErrorCode::invalid_input, "fit over contrast: no maximum of the quasi-likelihood was found");
}

Result<RampFit> RampFit::of(std::vector<RampAnswer> answers, ContrastSurface surface) {
  constexpr double straight_from = 0.05, bent_from = 0.3;
  std::erase_if(answers, [](const RampAnswer& one) { return !(one.answer.size > 0); });
  if (answers.empty()) return fail(ErrorCode::invalid_input, "fit over contrast: no answers");
  RampFit fit;
  fit.surface_ = std::move(surface);
  for (const RampAnswer& one : answers) fit.u_.push_back(contrast_bend(fit.surface_.noise(), one.delta_t_k));
  fit.answers_ = std::move(answers);
  const auto [least, most] = std::ranges::minmax(fit.u_);
  fit.powers_ = most - least < straight_from ? 1 : most - least < bent_from ? 2 : 3;
  TODBENCH_TRY_VOID(fit.climb(Directions::together));
  return fit;
}

double RampFit::stretch(double delta_t_k) const {
  auto basis = row(contrast_bend(surface_.noise(), delta_t_k), RampDirection::down, 0);
  if (parameters_ > powers_) basis[powers_] = 0;
  return dot(basis, value_);
}

/// In powers of u - centre the first parameter is the stretch at `centre`.
std::vector<AnswerScore> RampFit::scores(double centre) const {
  std::vector<AnswerScore> out;
  out.reserve(answers_.size());
  for (std::size_t i = 0; i < answers_.size(); ++i) {
    const RampAnswer& one = answers_[i];
    const double stretched = dot(row(u_[i], one.direction, 0), value_);
    const auto mean = surface_.at(std::log(one.answer.size) - stretched, one.delta_t_k);
    const double deviation = std::sqrt(mean.proportion * (1 - mean.proportion));
    AnswerScore score{.direction = row(u_[i], one.direction, centre),
                      .residual = (one.answer.probability_correct - mean.proportion) / deviation,
                      .presentation = one.answer.presentation,
                      .place = one.answer.place,
                      .set_up = one.answer.set_up};
    for (double& along : score.direction) along *= -mean.derivative / deviation;
    out.push_back(score);
  }
  return out;
}

RampValue RampFit::at(double delta_t_k) const {
  const std::vector<AnswerScore> all = scores(contrast_bend(surface_.noise(), delta_t_k));
  return {.ln_s75 = surface_.ln_threshold(delta_t_k) + stretch(delta_t_k),
          .variance = clustered_variance(all, parameters_, 0)};
}

std::optional<RampDifference> RampFit::up_against_down() const {
  RampFit apart = *this;
  if (!apart.climb(Directions::apart)) return std::nullopt;
  const ClusteredVariance found = clustered_variance(apart.scores(0), apart.parameters_, apart.powers_);
  RampDifference out{.ln_up_over_down = apart.value_[apart.powers_], .standard_error = std::sqrt(found.variance)};
  constexpr double false_alarm = 0.01;
  out.limit = out.standard_error * distribution::quantile_above(false_alarm / 2, found.degrees_of_freedom);
  return out;
}

}  // namespace todbench
