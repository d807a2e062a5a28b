// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/adequacy/alternatives.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

namespace todbench {
namespace {

constexpr std::size_t most_levels = 400;

struct Candidate {
  Alternative alternative;
  double criterion = 0;  // ln likelihood minus parameters
};

using Cubic = std::array<double, 4>;

double value_of(const Cubic& c, double y) {
  return c[0] + y * (c[1] + y * (c[2] + y * c[3]));
}

// u of the model as a cubic in the u of the fit.
struct CubicModel {
  const PooledCounts& counts;
  Link link;
  double slope = 1, t = 0;

  [[nodiscard]] double u_of_fit(double ln_size) const { return link.sign * slope * (ln_size - t); }

  [[nodiscard]] Expansion<4> expand(const Cubic& c) const {
    Expansion<4> e;
    e.value = 0;
    for (const PooledLevel& level : counts.levels) {
      const double y = u_of_fit(level.ln_size);
      const AnswerTerms terms = answer_terms(link, value_of(c, y));
      const auto mix = [&](double right, double wrong) {
        return (level.right > 0 ? level.right * right : 0) + (level.wrong > 0 ? level.wrong * wrong : 0);
      };
      e.value += mix(terms.right.value, terms.wrong.value);
      const double first = mix(terms.right.w, terms.wrong.w), second = mix(terms.right.ww, terms.wrong.ww);
      const std::array<double, 4> powers{1, y, y * y, y * y * y};
      for (std::size_t i = 0; i < 4; ++i) {
        e.gradient[i] += first * powers[i];
        for (std::size_t j = 0; j < 4; ++j) e.hessian[i][j] += second * powers[i] * powers[j];
      }
    }
    return e;
  }

  // The relative ln size nearest to t at which the cubic is 0, within the sizes and one step of the fit outside them.
  [[nodiscard]] std::optional<double> threshold(const Cubic& c) const {
    const double low = std::min(counts.first(), t) - 1 / slope, high = std::max(counts.last(), t) + 1 / slope;
    constexpr int steps = 400;
    std::optional<double> nearest;
    const auto at = [&](int i) { return low + (high - low) * i / steps; };
    for (int i = 0; i < steps; ++i) {
      double a = at(i), b = at(i + 1);
      const bool below = value_of(c, u_of_fit(a)) < 0;
      if (below == (value_of(c, u_of_fit(b)) < 0)) continue;
      for (int k = 0; k < 50; ++k) {
        const double middle = (a + b) / 2;
        ((value_of(c, u_of_fit(middle)) < 0) == below ? a : b) = middle;
      }
      if (!nearest || std::abs(a - t) < std::abs(*nearest - t)) nearest = a;
    }
    return nearest;
  }
};

std::optional<Candidate> refitted(std::span<const Level> levels, const PsychometricFit& fit, FitOptions options,
                                  const std::string& name, double parameters) {
  options.with_posterior = false;
  const auto other = fit_psychometric(levels, options);
  if (!other || !other->threshold || !other->log_likelihood) return std::nullopt;
  const bool free = !options.fixed_lapse;
  return Candidate{
      {free ? fmt::format("{} of {:.3g}", name, other->lapse) : name, std::log(*other->threshold / *fit.threshold)},
      *other->log_likelihood - parameters};
}

std::optional<Candidate> bent(const PooledCounts& counts, const PsychometricFit& fit, PsychometricForm form,
                              double lapse, double parameters) {
  const CubicModel model{counts, make_link(form, lapse), *fit.slope, counts.relative(*fit.threshold)};
  const ParameterBox<4> box{{-50, -50, -50, -50}, {50, 50, 50, 50}};
  const Maximum<4> best = climb<4>([&](const Cubic& c) { return model.expand(c); }, {0, 1, 0, 0}, box);
  const auto t = model.threshold(best.place);
  if (!t || !std::isfinite(best.expansion.value)) return std::nullopt;
  // The fit in the same groups, so that only the bend makes a difference.
  const double straight =
      log_likelihood(counts, form, {counts.relative(*fit.threshold), std::log(*fit.slope), fit.lapse});
  const double blank =
      log_likelihood(counts, form, {model.t, std::log(model.slope), lapse}) - model.expand({0, 1, 0, 0}).value;
  const double gain = best.expansion.value + blank - straight;
  return Candidate{{"a curve of free shape", *t - model.t}, *fit.log_likelihood + gain - parameters};
}

}  // namespace

std::optional<Alternative> best_alternative(std::span<const Level> levels, const PsychometricFit& fit,
                                            const FitOptions& options) {
  if (!fit.threshold || !fit.slope || !fit.log_likelihood) return std::nullopt;
  const PsychometricForm form = options.form;
  const PsychometricForm other = form == PsychometricForm::size ? PsychometricForm::acuity : PsychometricForm::size;
  const std::string name_of_other = "the " + std::string(to_string(other)) + " form";
  const double lapses = options.fixed_lapse ? 0 : 1;
  std::vector<std::optional<Candidate>> candidates;
  candidates.push_back(refitted(levels, fit, {other, options.fixed_lapse, false},
                                options.fixed_lapse ? name_of_other : name_of_other + " and a free lapse rate",
                                2 + lapses));
  if (options.fixed_lapse) {
    candidates.push_back(refitted(levels, fit, {form, std::nullopt, false}, "a free lapse rate", 3));
    candidates.push_back(
        refitted(levels, fit, {other, std::nullopt, false}, name_of_other + " and a free lapse rate", 3));
  }
  const PooledCounts counts = grouped(pool(levels), most_levels);
  candidates.push_back(bent(counts, fit, form, fit.lapse, 4 + lapses));
  for (const double lapse : {0.02, 0.05, 0.1})
    if (lapse > fit.lapse) candidates.push_back(bent(counts, fit, form, lapse, 5));
  const Candidate* best = nullptr;
  for (const auto& candidate : candidates)
    if (candidate && (best == nullptr || candidate->criterion > best->criterion)) best = &*candidate;
  return best != nullptr ? std::optional(best->alternative) : std::nullopt;
}

}  // namespace todbench
