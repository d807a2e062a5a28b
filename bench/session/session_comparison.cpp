// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/session_comparison.h"

#include <algorithm>

#include "acquisition/base/try.h"
#include "bench/plan/plan_options.h"
#include "bench/text/text.h"
#include "tod/adequacy/adequacy.h"
#include "tod/comparison/paired_ratio.h"

namespace todbench {
namespace {

/// Returns whether both are the same exposure of the same triangle: scores of different exposures differ at least in
/// their last digits.
bool same_trial(const Trial& a, const Trial& b) {
  return a.plate == b.plate && a.mounting == b.mounting && a.triangle == b.triangle &&
         a.set_delta_t_k == b.set_delta_t_k && a.size_mrad == b.size_mrad && a.answer == b.answer &&
         a.scores == b.scores;
}

/// Returns whether the trials of the shorter session are the first of the other: same folder, copy, replay or same
/// seed.
bool same_trials(const std::vector<Trial>& a, const std::vector<Trial>& b) {
  const std::size_t both = std::min(a.size(), b.size());
  return both > 0 && std::equal(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(both), b.begin(), same_trial);
}

/// Returns whether the function of a twin was fitted, or would have been fitted to better answers.
bool by_twin(const TodCurve& curve) {
  return std::ranges::any_of(curve.points, [](const TodPoint& point) {
    const auto& reason = point.estimator_reason;
    return point.fit.twin_shape || reason == EstimatorReason::irregular || reason == EstimatorReason::no_function ||
           reason == EstimatorReason::ended_early;
  });
}

std::string in_words(const Session& session) {
  const FitOptions fit = fit_options(session.plan);
  const std::string function = by_twin(*session.curve) ? std::string("the functions of the simulated twin")
                                                       : "the " + std::string(to_string(fit.form)) + " form";
  return function + " with " +
         (fit.fixed_lapse ? "a lapse of " + number_text(*fit.fixed_lapse) : std::string("a free lapse"));
}

/// Returns whether the fits agree. The fitted function counts, not the reason for its choice.
bool fitted_alike(const Session& a, const Session& b) {
  return a.plan.fit.form == b.plan.fit.form && a.plan.fit.lapse == b.plan.fit.lapse &&
         by_twin(*a.curve) == by_twin(*b.curve);
}

bool same_shape(const TargetPlate& a, const TargetPlate& b) {
  const auto same = [](const PlateTriangle& x, const PlateTriangle& y) {
    return x.name == y.name && x.position_mm == y.position_mm && x.size_mm == y.size_mm && x.apex == y.apex;
  };
  return a.width_mm == b.width_mm && a.height_mm == b.height_mm &&
         std::equal(a.triangles.begin(), a.triangles.end(), b.triangles.begin(), b.triangles.end(), same);
}

/// Returns the differences between the plates of two sessions in words; empty if there are none.
std::string difference_of_plates(std::vector<TargetPlate> a, std::vector<TargetPlate> b) {
  const auto by_name = [](const TargetPlate& x, const TargetPlate& y) { return x.name < y.name; };
  std::sort(a.begin(), a.end(), by_name);
  std::sort(b.begin(), b.end(), by_name);
  const auto names = [](const std::vector<TargetPlate>& plates) {
    std::string text;
    for (const TargetPlate& plate : plates) text += (text.empty() ? "" : ", ") + plate.name;
    return text;
  };
  if (names(a) != names(b)) return "the sessions used different plates (" + names(a) + " and " + names(b) + ")";
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!same_shape(a[i], b[i])) return "both sessions have a plate " + a[i].name + ", but its triangles differ";
  return "";
}

Result<void> check_comparable(const Session& a, const Session& b) {
  if (!a.curve || !b.curve)
    return fail(ErrorCode::invalid_input,
                std::string("the ") + (a.curve ? "second" : "first") + " session has no curve");
  if (same_trials(a.trials, b.trials))
    return fail(ErrorCode::invalid_input,
                "both sessions contain the same trials: a session cannot be compared with itself");
  if (!fitted_alike(a, b))
    return fail(ErrorCode::invalid_input,
                "the curves were fitted differently: " + in_words(a) + ", and " + in_words(b));
  const TemplateObserverSpec &observer_a = a.parts.observer, &observer_b = b.parts.observer;
  if (observer_a.name != observer_b.name)
    return fail(ErrorCode::invalid_input,
                "the sessions have different observers: " + observer_a.name + " and " + observer_b.name);
  if (!(observer_a == observer_b))
    return fail(ErrorCode::invalid_input,
                "the observers of both sessions are named " + observer_a.name + ", but their parameters differ");
  return {};
}

double margin_of(const Session& a, const Session& b) {
  const auto& of_a = a.plan.limits.equivalence_margin_percent;
  const auto& of_b = b.plan.limits.equivalence_margin_percent;
  if (of_a && of_b) return std::min(*of_a, *of_b);
  return of_a ? *of_a : of_b.value_or(ComparisonOptions{}.margin_percent);
}

TodCurve examined(const Session& session) {
  TodCurve curve = *session.curve;
  const bool known =
      std::all_of(curve.points.begin(), curve.points.end(), [](const TodPoint& p) { return p.adequacy.has_value(); });
  if (!known) examine(curve, fit_options(session.plan));
  return curve;
}

/// Adds ratios over the twin if both sessions were paired with the same twin at the same contrasts.
void add_ratios_over_twin(Comparison& comparison, const Session& a, const Session& b) {
  if (!a.comparison || !b.comparison || !(a.parts.sensor == b.parts.sensor)) return;
  const auto paired_at = [](const Session& session, double set_delta_t_k) -> const ComparisonPoint* {
    for (const ComparisonPoint& point : session.comparison->points)
      if (point.paired && same_contrast(point.set_delta_t_k, set_delta_t_k)) return &point;
    return nullptr;
  };
  for (std::size_t i = 0; i < comparison.points.size(); ++i) {
    const ComparisonPoint& point = comparison.points[i];
    const ComparisonPoint *of_a = paired_at(a, point.set_delta_t_k), *of_b = paired_at(b, point.set_delta_t_k);
    if (of_a == nullptr || of_b == nullptr) continue;
    RatioOfPairs ratio = ratio_of_paired(*of_a->paired, *of_b->paired, point.margin_percent);
    // The threshold of the twin may be unfit although both cameras' are fit.
    if (of_a->withheld || of_b->withheld) ratio.verdict = ComparisonVerdict::inconclusive;
    add_paired(comparison, i, ratio);
  }
}

}  // namespace

Result<SessionComparison> compare_sessions(const Session& a, const Session& b, std::optional<double> margin_percent) {
  TODBENCH_TRY_VOID(check_comparable(a, b));
  ComparisonOptions options = comparison_options(a.plan);
  options.margin_percent = margin_percent.value_or(margin_of(a, b));
  SessionComparison result{examined(a), examined(b), {}};
  TODBENCH_TRY(auto comparison, compare(result.a, result.b, options));
  result.comparison = std::move(comparison);
  add_ratios_over_twin(result.comparison, a, b);
  if (const std::string difference = difference_of_plates(a.parts.plates, b.parts.plates); !difference.empty()) {
    add_finding(result.comparison, {.kind = FindingKind::identity,
                                    .sentence = difference + ": the plates may cause the difference",
                                    .unfit = true});
  }
  return result;
}

}  // namespace todbench
