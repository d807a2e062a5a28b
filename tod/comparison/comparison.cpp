// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/comparison/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "acquisition/base/distributions.h"
#include "acquisition/base/try.h"
#include "tod/psychometric/acuity.h"
#include "tod/psychometric/contrast_slope.h"
#include "tod/psychometric/threshold_pair.h"

namespace todbench {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

// Larger of the two one-sided probabilities of this estimate for a ratio at or beyond the margin (Schuirmann 1987).
double wald_equivalence_probability(double ln_ratio, double se, double margin_percent) {
  return distribution::tail_above((std::log1p(margin_percent / 100) - std::abs(ln_ratio)) / se, infinite);
}

// A threshold that may be used for a ratio. A slope at its lower bound or a ridge has a meaningless threshold.
std::optional<double> ln_threshold(const PsychometricFit& fit) {
  const bool meaningful =
      fit.verdict == FitVerdict::ok || fit.verdict == FitVerdict::extrapolated || fit.verdict == FitVerdict::step;
  const auto threshold = stated_threshold(fit);
  if (!meaningful || !threshold) return std::nullopt;
  return std::log(*threshold);
}

// Interval of exp(tb - ta) from the intervals of both, asymmetric on the log scale (method of variance estimates
// recovery, Zou and Donner 2008), and a half-width added to either side. A side is open if one of its two source sides
// is.
Interval ratio_interval(double ta, const Interval& a, double tb, const Interval& b, double half) {
  Interval ratio;
  const double d = tb - ta;
  if (b.low && a.high) ratio.low = std::exp(d - std::hypot(tb - std::log(*b.low), std::log(*a.high) - ta, half));
  if (b.high && a.low) ratio.high = std::exp(d + std::hypot(std::log(*b.high) - tb, ta - std::log(*a.low), half));
  return ratio;
}

// Effect of clusters and of the scatter of the contrast on the difference of two ln thresholds.
struct DifferenceSpread {
  double inflation = 1;                  // of the variance of the difference
  double degrees_of_freedom = infinite;  // Welch and Satterthwaite; infinite without clusters
};

DifferenceSpread spread_of(const PsychometricFit& a, const PsychometricFit& b, const ContrastScatter& contrast) {
  DifferenceSpread spread;
  const auto freedom = [](const PsychometricFit& fit) {
    return fit.clusters > 0 ? std::max(fit.clusters - 1, 1.0) : infinite;
  };
  if (!a.se_ln_threshold || !b.se_ln_threshold) {
    spread.inflation = std::max(a.variance_inflation, b.variance_inflation);
    spread.degrees_of_freedom = std::min(freedom(a), freedom(b));
    return spread;
  }
  const double plain_a = *a.se_ln_threshold * *a.se_ln_threshold, plain_b = *b.se_ln_threshold * *b.se_ln_threshold;
  const double va = a.variance_inflation * plain_a, vb = b.variance_inflation * plain_b;
  const double vc = contrast.se_ln_acuity * contrast.se_ln_acuity, all = va + vb + vc;
  spread.inflation = all / (plain_a + plain_b);
  const double rest =
      va * va / freedom(a) + vb * vb / freedom(b) + vc * vc / contrast.degrees_of_freedom.value_or(infinite);
  if (rest > 0) spread.degrees_of_freedom = all * all / rest;
  return spread;
}

// The same from the interval: on each side the log ratio is normal (or t) with the spread of that side of the 90 %
// interval, so that the probability is 0.05 if the interval touches the margin.
std::optional<double> equivalence_probability(double ln_ratio, const Interval& ci90, double margin_percent,
                                              double degrees_of_freedom) {
  if (!ci90.low || !ci90.high) return std::nullopt;
  const double below = ln_ratio - std::log(*ci90.low), above = std::log(*ci90.high) - ln_ratio;
  if (!(below > 0 && above > 0)) return std::nullopt;
  const double margin = std::log1p(margin_percent / 100);
  const double quantile = distribution::quantile_above(0.05, degrees_of_freedom);
  return std::max(distribution::tail_above(quantile * (margin - ln_ratio) / above, degrees_of_freedom),
                  distribution::tail_above(quantile * (margin + ln_ratio) / below, degrees_of_freedom));
}

ComparisonVerdict verdict_of(const ComparisonPoint& point) {
  const double margin = 1 + point.margin_percent / 100;
  const Interval& ci = point.ratio_ci90;
  if (!point.ratio || !ci.low || !ci.high || !point.ratio_ci95.low || !point.ratio_ci95.high)
    return ComparisonVerdict::inconclusive;
  if (*ci.low >= 1 / margin && *ci.high <= margin) return ComparisonVerdict::equivalent;
  return point.p_difference && *point.p_difference < 0.05 ? ComparisonVerdict::different
                                                          : ComparisonVerdict::inconclusive;
}

bool unfit(const TodPoint& point) {
  return point.adequacy && !point.adequacy->adequate();
}

// If only one function is that of the twin, the difference of the functions is not that of the cameras.
bool other_functions(const TodPoint& a, const TodPoint& b) {
  return estimator_of(a.fit) != estimator_of(b.fit);
}

// Answers of two runs never agree row by row.
bool same_answers(const TodPoint& a, const TodPoint& b) {
  const auto same = [](const Level& x, const Level& y) {
    return x.size == y.size && x.correct == y.correct && x.total == y.total;
  };
  return !a.levels.empty() && std::equal(a.levels.begin(), a.levels.end(), b.levels.begin(), b.levels.end(), same);
}

// Adds the findings that make a point unfit, with curve and contrast.
void add_unfit(Adequacy& adequacy, const TodPoint& point, const char* which) {
  if (!unfit(point)) return;
  for (AdequacyFinding finding : point.adequacy->findings) {
    if (!finding.unfit) continue;
    finding.sentence = fmt::format("{} curve at {:.4g} K: {}", which, point.set_delta_t_k, finding.sentence);
    adequacy.findings.push_back(std::move(finding));
  }
}

// The point of the other curve at this contrast, if each is the nearest of the other.
const TodPoint* partner(const TodPoint& point, const TodCurve& own, const TodCurve& other) {
  const TodPoint* found = point_at(other, point.set_delta_t_k);
  return found != nullptr && point_at(own, found->set_delta_t_k) == &point ? found : nullptr;
}

// Two-sided probability of a ratio at least as far from 1 for equal cameras: by likelihood ratio, or from the standard
// errors if one function is that of a twin and there is no common likelihood.
Result<double> difference_probability(const TodPoint& a, const TodPoint& b, const DifferenceSpread& spread,
                                      const ComparisonOptions& options) {
  if ((a.fit.twin_shape || b.fit.twin_shape) && a.fit.se_ln_threshold && b.fit.se_ln_threshold) {
    const double plain = std::hypot(*a.fit.se_ln_threshold, *b.fit.se_ln_threshold);
    const double distance = std::abs(std::log(*a.fit.threshold / *b.fit.threshold));
    return std::min(
        1.0, 2 * distribution::tail_above(distance / (plain * std::sqrt(spread.inflation)), spread.degrees_of_freedom));
  }
  FitOptions fit = options.fit;
  fit.graded = is_quasi(a.fit.interval) || is_quasi(b.fit.interval);
  TODBENCH_TRY(const auto test, test_thresholds(a.levels, b.levels, SlopeModel::separate, options.margin_percent, fit));
  return std::min(1.0, 2 * distribution::tail_above(std::sqrt(test.lr / spread.inflation), spread.degrees_of_freedom));
}

Result<ComparisonPoint> compare_points(const TodPoint& a, const TodPoint& b, const ContrastScatter& contrast,
                                       const ComparisonOptions& options) {
  ComparisonPoint point;
  point.set_delta_t_k = a.set_delta_t_k;
  point.delta_t_a_k = a.delta_t_k;
  point.delta_t_b_k = b.delta_t_k;
  point.margin_percent = options.margin_percent;
  point.withheld = unfit(a) || unfit(b);
  const auto ta = ln_threshold(a.fit), tb = ln_threshold(b.fit);
  if (!ta || !tb) return point;
  point.ratio = std::exp(*tb - *ta);
  // The part that the interval of the first already contains is not added again.
  const double rest = std::sqrt(std::max(0.0, std::pow(contrast.se_ln_acuity, 2) - std::pow(a.fit.joined_u, 2)));
  const auto of_contrast = [&](double tail) {
    return rest > 0 ? rest * distribution::quantile_above(tail, contrast.degrees_of_freedom) : 0;
  };
  point.ratio_ci95 = ratio_interval(*ta, a.fit.ci95, *tb, b.fit.ci95, of_contrast(0.025));
  point.ratio_ci90 = ratio_interval(*ta, a.fit.ci90, *tb, b.fit.ci90, of_contrast(0.05));
  const DifferenceSpread spread = spread_of(a.fit, b.fit, contrast);
  TODBENCH_TRY(point.p_difference, difference_probability(a, b, spread, options));
  point.p_equivalence =
      equivalence_probability(*tb - *ta, point.ratio_ci90, options.margin_percent, spread.degrees_of_freedom);
  point.withheld = point.withheld || other_functions(a, b);
  point.verdict = point.withheld ? ComparisonVerdict::inconclusive : verdict_of(point);
  return point;
}

ComparisonVerdict overall(const std::vector<ComparisonPoint>& points) {
  const auto any = [&points](ComparisonVerdict v) {
    return std::any_of(points.begin(), points.end(),
                       [v](const ComparisonPoint& p) { return (p.paired ? p.paired->verdict : p.verdict) == v; });
  };
  if (any(ComparisonVerdict::different)) return ComparisonVerdict::different;
  return any(ComparisonVerdict::inconclusive) ? ComparisonVerdict::inconclusive : ComparisonVerdict::equivalent;
}

}  // namespace

std::string_view to_string(ComparisonVerdict verdict) {
  switch (verdict) {
    case ComparisonVerdict::equivalent:
      return "equivalent";
    case ComparisonVerdict::different:
      return "different";
    case ComparisonVerdict::inconclusive:
      return "inconclusive";
  }
  return "unknown";
}

Result<ThresholdTest> test_thresholds(std::span<const Level> a, std::span<const Level> b, SlopeModel slopes,
                                      double margin_percent, const FitOptions& options) {
  if (!(margin_percent > 0) || !std::isfinite(margin_percent))
    return fail(ErrorCode::invalid_input, "the equivalence margin must be positive");
  FitOptions single = options;
  single.with_posterior = false;
  const auto fit_a = fit_psychometric(a, single);
  if (!fit_a) return fail("data set A", fit_a.error());
  const auto fit_b = fit_psychometric(b, single);
  if (!fit_b) return fail("data set B", fit_b.error());
  for (const auto& [fit, name] : {std::pair(&*fit_a, "A"), std::pair(&*fit_b, "B")})
    if (!fit->threshold)
      return fail(ErrorCode::invalid_input,
                  std::string("data set ") + name + " has no threshold: " + std::string(to_string(fit->verdict)));

  const ThresholdPair pair(a, b, options);
  const PairMaxima maxima = slopes == SlopeModel::shared ? pair.shared_slope() : pair.separate_slopes();
  ThresholdTest test;
  test.ll_separate = std::max(maxima.ll_separate, maxima.ll_common);
  test.ll_common = maxima.ll_common;
  test.lr = 2 * (test.ll_separate - test.ll_common);
  test.p_difference = std::min(1.0, 2 * distribution::tail_above(std::sqrt(test.lr), infinite));
  test.ln_ratio = maxima.ln_ratio;
  test.se_ln_ratio = maxima.se_ln_ratio.value_or(0.0);
  if (maxima.se_ln_ratio)
    test.p_equivalence = wald_equivalence_probability(test.ln_ratio, *maxima.se_ln_ratio, margin_percent);
  return test;
}

Result<Comparison> compare(const TodCurve& a, const TodCurve& b, const ComparisonOptions& options) {
  if (!(options.margin_percent > 0) || !std::isfinite(options.margin_percent))
    return fail(ErrorCode::invalid_input, "the equivalence margin must be positive");
  if (a.observer != b.observer)
    return fail(ErrorCode::invalid_input,
                "the curves were measured with different observers: " + a.observer + " and " + b.observer);
  Comparison comparison{.points = {}, .verdict = {}, .adequacy = Adequacy{}};
  bool same = true;
  const std::vector<ContrastScatter> contrasts =
      options.b_shown_contrasts_of_a ? contrast_scatter(a) : std::vector<ContrastScatter>(a.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    const TodPoint& point = a.points[i];
    const TodPoint* other = partner(point, a, b);
    if (other == nullptr) continue;
    same = same && same_answers(point, *other);
    add_unfit(*comparison.adequacy, point, "first");
    add_unfit(*comparison.adequacy, *other, "second");
    auto compared = compare_points(point, *other, contrasts[i], options);
    if (!compared) return fail(fmt::format("comparing at {:.6g} K", point.set_delta_t_k), compared.error());
    if (other_functions(point, *other) && compared->ratio) {
      const std::string sentence = fmt::format(
          "at {:.4g} K one curve is fitted with the function of the twin, the other with a Weibull function",
          point.set_delta_t_k);
      comparison.adequacy->findings.push_back({.kind = FindingKind::identity, .sentence = sentence, .unfit = true});
    }
    comparison.points.push_back(*compared);
  }
  if (comparison.points.empty()) return fail(ErrorCode::invalid_input, "the two curves have no contrast in common");
  comparison.verdict = overall(comparison.points);
  if (same) {
    add_finding(comparison,
                {.kind = FindingKind::identity,
                 .sentence = "both curves contain the same answers: their agreement is no evidence of equivalence",
                 .unfit = true});
  }
  return comparison;
}

void add_finding(Comparison& comparison, AdequacyFinding finding) {
  if (finding.unfit) {
    for (ComparisonPoint& point : comparison.points) {
      point.withheld = true;
      point.verdict = ComparisonVerdict::inconclusive;
      if (point.paired) point.paired->verdict = ComparisonVerdict::inconclusive;
    }
    comparison.verdict = ComparisonVerdict::inconclusive;
  }
  if (!comparison.adequacy) comparison.adequacy.emplace();
  comparison.adequacy->findings.push_back(std::move(finding));
}

void add_paired(Comparison& comparison, std::size_t point, const RatioOfPairs& paired) {
  ComparisonPoint& at = comparison.points[point];
  at.paired = paired;
  if (at.withheld) at.paired->verdict = ComparisonVerdict::inconclusive;
  comparison.verdict = overall(comparison.points);
}

bool decided_by_pairs(const Comparison& comparison) {
  return !comparison.points.empty() &&
         std::ranges::all_of(comparison.points, [](const ComparisonPoint& point) { return point.paired.has_value(); });
}

Comparison as_decided(Comparison comparison) {
  for (ComparisonPoint& point : comparison.points) {
    if (!point.paired) continue;
    const RatioOfPairs& paired = *point.paired;
    point.ratio = paired.ratio;
    point.ratio_ci95 = paired.ci95;
    point.ratio_ci90 = paired.ci90;
    point.p_difference = paired.p_difference;
    point.p_equivalence = paired.p_equivalence;
    point.verdict = paired.verdict;
  }
  return comparison;
}

}  // namespace todbench
