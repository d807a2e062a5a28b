// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/psychometric/psychometric_fit.h"

#include <cmath>
#include <string>

#include "acquisition/base/try.h"
#include "tod/psychometric/acuity.h"
#include "tod/psychometric/psychometric_clusters.h"
#include "tod/psychometric/psychometric_likelihood.h"
#include "tod/psychometric/psychometric_posterior.h"
#include "tod/psychometric/psychometric_profile.h"
#include "tod/psychometric/psychometric_search.h"

namespace todbench {
namespace {

// Properties of the likelihood before the verdict.
struct Surface {
  PooledCounts counts;
  PsychometricForm form = PsychometricForm::size;
  std::optional<double> lapse;
  ScanGrid grid;
  LikelihoodScan scan;
  LikelihoodLimits limits;
  Maximum<3> maximum;

  [[nodiscard]] double supremum() const { return std::max({maximum.expansion.value, limits.chance, limits.ceiling}); }
  // Likelihoods closer than this are equal: 1e-9, or the rounding of a sum over very many trials.
  [[nodiscard]] double equal_within() const { return 1e-9 + 4e-16 * std::abs(supremum()); }
};

// A verdict, and whether the maximum is a point that may be reported.
struct Judgement {
  FitVerdict verdict = FitVerdict::no_data;
  bool has_point = false;
};

bool at_upper_slope(const Maximum<3>& m) {
  return m.place[place_q] >= std::log(max_slope) - 1e-9;
}
bool at_lower_slope(const Maximum<3>& m) {
  return m.place[place_q] <= std::log(min_slope) + 1e-9;
}

// The likelihood is flat along slope -> infinity: a step that touches no level, or one informative level.
bool is_flat_step(const LikelihoodLimits& limits, double supremum, double equal_within) {
  return std::abs(limits.step - supremum) <= equal_within;
}

Judgement judge(const Surface& s) {
  const double supremum = s.supremum(), equal = s.equal_within();
  if (s.limits.chance >= supremum - equal) return {FitVerdict::above_range, false};
  if (s.limits.ceiling >= supremum - equal) return {FitVerdict::below_range, false};
  if (s.counts.levels.size() == 1) return {FitVerdict::slope_unidentifiable, false};
  const std::size_t parameters = s.lapse ? 2 : 3;
  const bool short_of_levels = parameters > s.counts.levels.size();
  // With more parameters than levels the flat direction is the ridge, unless even its member with the smallest lapse is
  // a step (see ridge_foot).
  const bool flat_step = is_flat_step(s.limits, supremum, equal);
  const bool on_foot = short_of_levels && s.maximum.place[place_lapse] == 0 && !at_upper_slope(s.maximum) &&
                       !is_flat_step(likelihood_limits(s.counts, 0.0), supremum, equal);
  if (flat_step && !on_foot) return {FitVerdict::step, false};
  if (at_upper_slope(s.maximum)) return {FitVerdict::step, true};
  if (at_lower_slope(s.maximum)) return {FitVerdict::flat_or_decreasing, true};
  if (short_of_levels) return {FitVerdict::underdetermined, true};
  const double t = s.maximum.place[place_t];
  if (t < s.counts.first() || t > s.counts.last()) return {FitVerdict::extrapolated, true};
  return {FitVerdict::ok, true};
}

// Two levels and a free lapse leave a ridge of equal likelihood; its member with the smallest lapse represents it.
Maximum<3> ridge_foot(const Surface& s) {
  if (s.lapse || s.counts.levels.size() != 2) return s.maximum;
  const Maximum<3> foot = global_maximum(s.counts, s.form, scan_likelihood(s.counts, scan_grid(s.form, 0.0)), 0.0);
  return foot.expansion.value >= s.maximum.expansion.value - s.equal_within() ? foot : s.maximum;
}

std::optional<double> standard_error(const Maximum<3>& m) {
  const auto column = solve_information(m.expansion.hessian, {1, 0, 0}, m.free, 0);
  if (!column || !m.free[place_t] || !((*column)[place_t] > 0)) return std::nullopt;
  const double se = std::sqrt((*column)[place_t]);
  return std::isfinite(se) ? std::optional(se) : std::nullopt;
}

double start_of_profile(const Surface& s, FitVerdict verdict) {
  // At slope 50 a distance of 1.5 in ln size puts every level at its asymptote (z < e^-75), so that the supremum is
  // reached there.
  constexpr double beyond = 1.5;
  if (verdict == FitVerdict::above_range) return s.counts.last() + beyond;
  if (verdict == FitVerdict::below_range) return s.counts.first() - beyond;
  return s.maximum.place[place_t];
}

Interval interval(const PooledCounts& counts, std::optional<double> low, std::optional<double> high) {
  Interval sizes;
  if (low) sizes.low = counts.size_at(*low);
  if (high) sizes.high = counts.size_at(*high);
  return sizes;
}

// Two-sided 95 % if both sides close; else the closing side's one-sided 95 % limit, which is its 90 % crossing.
Interval interval95(const PooledCounts& counts, const ProfileCrossings& c) {
  if (c.below.wide && c.above.wide) return interval(counts, c.below.wide, c.above.wide);
  if (c.above.wide || (!c.below.wide && !c.below.narrow)) return interval(counts, std::nullopt, c.above.narrow);
  if (c.below.wide || !c.above.narrow) return interval(counts, c.below.narrow, std::nullopt);
  return {};
}

// A step lies anywhere in its gap. If the gap is so narrow that the steepest function of the domain falls short of an
// ideal step, the profile over the domain does not contain it: the interval is joined with all ideal steps that the
// data do not exclude. `drop`: of twice the ln likelihood.
void join_steps(const Surface& s, double drop, Interval& sizes) {
  constexpr double falls_short = 1;  // of ln likelihood: half of the drop of a 95 % interval
  if (s.limits.step - s.supremum() < falls_short) return;
  const double supremum = s.limits.step;
  const StepExtent steps = step_extent(s.counts, s.lapse, supremum - drop / 2 - s.equal_within());
  if (!steps.any) return;
  const auto lower = [](const std::optional<double>& a, const std::optional<double>& b) {
    return a && b ? std::optional(std::min(*a, *b)) : std::nullopt;
  };
  const auto upper = [](const std::optional<double>& a, const std::optional<double>& b) {
    return a && b ? std::optional(std::max(*a, *b)) : std::nullopt;
  };
  sizes.low = lower(sizes.low, steps.low ? s.counts.size_at(*steps.low) : std::nullopt);
  sizes.high = upper(sizes.high, steps.high ? s.counts.size_at(*steps.high) : std::nullopt);
}

// The maximum with every size as it is, after a search in groups; intervals move with it.
void refine(const PooledCounts& counts, const Surface& s, PsychometricFit& fit) {
  fit.degrees_of_freedom += static_cast<int>(counts.levels.size()) - static_cast<int>(s.counts.levels.size());
  if (!fit.threshold) return;
  const auto likelihood = [&](const PsychometricPlace& place) { return expand_likelihood(counts, s.form, place); };
  const Maximum<3> exact = climb<3>(likelihood, s.maximum.place, search_box(s.lapse));
  const double moved = std::exp(exact.place[place_t] - s.maximum.place[place_t]);
  fit.threshold = counts.size_at(exact.place[place_t]);
  fit.slope = std::exp(exact.place[place_q]);
  fit.lapse = s.lapse.value_or(exact.place[place_lapse]);
  fit.log_likelihood = exact.expansion.value;
  fit.deviance = deviance(counts, s.form, exact.place);
  for (std::optional<double>* side : {&fit.ci95.low, &fit.ci95.high, &fit.ci90.low, &fit.ci90.high})
    if (*side) **side *= moved;
  if (!fit.posterior) return;
  for (double* quantile : {&fit.posterior->median, &fit.posterior->low, &fit.posterior->high}) *quantile *= moved;
}

Surface survey(PooledCounts counts, const FitOptions& options) {
  Surface s;
  s.counts = std::move(counts);
  s.form = options.form;
  s.lapse = options.fixed_lapse;
  s.grid = scan_grid(s.form, s.lapse);
  s.limits = likelihood_limits(s.counts, s.lapse);
  s.scan = scan_likelihood(s.counts, s.grid);
  s.maximum = global_maximum(s.counts, s.form, s.scan, s.lapse);
  return s;
}

// Fills in the results of the maximum; the intervals come later.
PsychometricFit describe(const Surface& s, const Judgement& judgement) {
  PsychometricFit fit;
  fit.verdict = judgement.verdict;
  fit.trials = s.counts.trials();
  fit.lapse = s.lapse.value_or(s.maximum.place[place_lapse]);
  if (!s.lapse && judgement.verdict == FitVerdict::below_range) fit.lapse = s.limits.ceiling_lapse;
  if (!s.lapse && judgement.verdict == FitVerdict::above_range) fit.lapse = 0;
  const bool blank = s.counts.blank_right + s.counts.blank_wrong > 0;
  fit.degrees_of_freedom = static_cast<int>(s.counts.levels.size()) + (blank ? 1 : 0) - (s.lapse ? 2 : 3);
  if (judgement.has_point) {
    fit.threshold = s.counts.size_at(s.maximum.place[place_t]);
    fit.slope = std::exp(s.maximum.place[place_q]);
    fit.slope_at_cap = at_upper_slope(s.maximum);
    fit.log_likelihood = s.maximum.expansion.value;
    fit.deviance = deviance(s.counts, s.form, s.maximum.place);
  } else {
    fit.log_likelihood = s.supremum();
    fit.deviance = std::max(0.0, 2 * (saturated(s.counts) - s.supremum()));
  }
  const bool regular = judgement.verdict == FitVerdict::ok || judgement.verdict == FitVerdict::extrapolated;
  if (regular) fit.se_ln_threshold = standard_error(s.maximum);
  return fit;
}

// Profile crossings. If the profile meets a higher place than the search found, everything is evaluated again from
// there.
template <typename EffectOf>
ProfileCrossings add_intervals(Surface& s, PsychometricFit& fit, const EffectOf& effect_of) {
  constexpr int most_restarts = 3;
  ProfileCrossings crossings;
  for (int attempt = 0; attempt <= most_restarts; ++attempt) {
    const Judgement judgement = judge(s);
    fit = describe(s, judgement);
    const ClusterEffect effect = effect_of(s, fit);
    fit.clusters = effect.clusters;
    fit.variance_inflation = effect.inflation;
    ProfileRequest request;
    request.start_t = start_of_profile(s, judgement.verdict);
    request.supremum = s.supremum();
    request.se_t = fit.se_ln_threshold;
    request.limits = s.limits;
    request.wide_drop = confidence_drop(effect, 0.95);
    request.narrow_drop = confidence_drop(effect, 0.90);
    crossings = profile_crossings(s.counts, s.form, s.grid, s.lapse, request);
    if (!crossings.better) break;
    const auto likelihood = [&s](const PsychometricPlace& place) { return expand_likelihood(s.counts, s.form, place); };
    s.maximum = climb<3>(likelihood, crossings.better->place, search_box(s.lapse));
  }
  return crossings;
}

}  // namespace

std::string_view to_string(PsychometricForm form) {
  switch (form) {
    case PsychometricForm::size:
      return "size";
    case PsychometricForm::acuity:
      return "acuity";
  }
  return "unknown";
}

std::string_view to_string(FitEstimator estimator) {
  switch (estimator) {
    case FitEstimator::weibull:
      return "weibull";
    case FitEstimator::twin_shape:
      return "twin-shape";
  }
  return "unknown";
}

std::string_view to_string(EstimatorReason reason) {
  switch (reason) {
    case EstimatorReason::plan:
      return "plan";
    case EstimatorReason::twin:
      return "twin";
    case EstimatorReason::no_twin:
      return "no-twin";
    case EstimatorReason::person:
      return "person";
    case EstimatorReason::modules:
      return "modules";
    case EstimatorReason::package:
      return "package";
    case EstimatorReason::moving_target:
      return "moving-target";
    case EstimatorReason::irregular:
      return "irregular";
    case EstimatorReason::no_function:
      return "no-function";
    case EstimatorReason::ended_early:
      return "ended-early";
  }
  return "unknown";
}

std::string_view in_words(EstimatorReason reason) {
  switch (reason) {
    case EstimatorReason::plan:
      return "the plan names it";
    case EstimatorReason::twin:
      return "there is a simulated twin";
    case EstimatorReason::no_twin:
      return "there is no simulated twin";
    case EstimatorReason::person:
      return "a person answered";
    case EstimatorReason::modules:
      return "the function of the sensor does not describe the chain with its modules";
    case EstimatorReason::package:
      return "the function of the sensor does not describe the picture behind a package";
    case EstimatorReason::moving_target:
      return "the function of the twin is valid for a target at rest only";
    case EstimatorReason::irregular:
      return "the fit of the answers has no regular maximum";
    case EstimatorReason::no_function:
      return "the twin has no usable function at this contrast";
    case EstimatorReason::ended_early:
      return "the run ended before the functions of the twin were computed";
  }
  return "unknown";
}

std::string_view to_string(IntervalKind kind) {
  switch (kind) {
    case IntervalKind::independent:
      return "independent";
    case IntervalKind::clusters:
      return "clusters";
    case IntervalKind::two_way:
      return "two_way";
    case IntervalKind::set_ups:
      return "set_ups";
  }
  return "unknown";
}

std::string_view to_string(FitVerdict verdict) {
  switch (verdict) {
    case FitVerdict::no_data:
      return "no_data";
    case FitVerdict::above_range:
      return "above_range";
    case FitVerdict::below_range:
      return "below_range";
    case FitVerdict::slope_unidentifiable:
      return "slope_unidentifiable";
    case FitVerdict::step:
      return "step";
    case FitVerdict::flat_or_decreasing:
      return "flat_or_decreasing";
    case FitVerdict::underdetermined:
      return "underdetermined";
    case FitVerdict::extrapolated:
      return "extrapolated";
    case FitVerdict::ok:
      return "ok";
  }
  return "unknown";
}

bool PsychometricFit::usable() const {
  return (verdict == FitVerdict::ok || verdict == FitVerdict::extrapolated) && ci95.low && ci95.high;
}

namespace {

/// Everything except clusters: `effect_of(surface, fit)` returns their effect, and may record more in the fit.
template <typename EffectOf>
PsychometricFit fitted(std::span<const Level> levels, const FitOptions& options, const EffectOf& effect_of) {
  PooledCounts counts = pool(levels);
  PsychometricFit fit;
  fit.lapse = options.fixed_lapse.value_or(0.0);
  fit.trials = counts.trials();
  if (counts.levels.empty()) return fit;
  constexpr std::size_t most_levels = 400;
  const bool in_groups = counts.levels.size() > most_levels;
  Surface s = survey(in_groups ? grouped(counts, most_levels) : counts, options);
  s.maximum = ridge_foot(s);
  const ProfileCrossings crossings = add_intervals(s, fit, effect_of);
  fit.ci95 = interval95(s.counts, crossings);
  fit.ci90 = interval(s.counts, crossings.below.narrow, crossings.above.narrow);
  if (fit.verdict == FitVerdict::step) {
    const ClusterEffect effect{fit.clusters, fit.variance_inflation};
    join_steps(s, confidence_drop(effect, 0.95), fit.ci95);
    join_steps(s, confidence_drop(effect, 0.90), fit.ci90);
  }
  if (options.with_posterior && !options.graded)
    fit.posterior = grid_posterior(s.counts, s.form, s.scan.nodes, s.lapse);
  if (in_groups) refine(counts, s, fit);
  if (fit.verdict == FitVerdict::flat_or_decreasing) remove_threshold(fit);
  return fit;
}

Result<void> check_lapse(const FitOptions& options) {
  if (options.fixed_lapse && !(*options.fixed_lapse >= 0 && *options.fixed_lapse <= max_free_lapse))
    return fail(ErrorCode::invalid_input, "the lapse rate must be from 0 to 0.1");
  return {};
}

}  // namespace

Result<PsychometricFit> fit_psychometric(std::span<const Level> levels, const FitOptions& options) {
  TODBENCH_TRY_VOID(validate(levels, options.graded ? Counts::fractional : Counts::whole));
  TODBENCH_TRY_VOID(check_lapse(options));
  return fitted(levels, options, [&](const Surface& s, PsychometricFit& fit) {
    const ClusterEffect effect = cluster_effect(levels, s.counts, s.form, s.maximum, fit.se_ln_threshold);
    fit.interval = effect.clusters > 0 ? IntervalKind::clusters : IntervalKind::independent;
    return effect;
  });
}

Result<PsychometricFit> fit_graded(std::span<const GradedAnswer> answers, const FitOptions& options) {
  std::vector<Level> levels;
  for (const GradedAnswer& answer : answers)
    levels.push_back({.size = answer.size, .correct = answer.probability_correct, .total = 1, .cluster = -1});
  TODBENCH_TRY_VOID(validate(levels, Counts::fractional));
  TODBENCH_TRY_VOID(check_lapse(options));
  FitOptions graded = options;
  graded.graded = true;
  return fitted(levels, graded, [&](const Surface& s, PsychometricFit& fit) {
    const GradedEffect effect = graded_effect(answers, s.counts, s.form, s.maximum, fit.se_ln_threshold);
    fit.interval = effect.kind;
    fit.dispersion = effect.dispersion;
    return effect.clusters;
  });
}

}  // namespace todbench
