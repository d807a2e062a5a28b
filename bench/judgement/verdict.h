// SPDX-License-Identifier: GPL-3.0-or-later
// Verdict of a session (pass, fail or inconclusive) from the limits of the plan and the results, and the exit code of
// the program.
#pragma once

#include <array>
#include <compare>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/judgement/acuity_uncertainty.h"
#include "bench/judgement/conformity.h"
#include "bench/plan/plan.h"
#include "tod/comparison/comparison.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Decision of a verdict.
enum class VerdictKind { pass, fail, inconclusive };
/// Returns the name of the enumerator.
[[nodiscard]] std::string_view to_string(VerdictKind kind);

/// Returns the decision rule of the plan in words.
[[nodiscard]] std::string in_words(ConformityRule rule, const std::optional<double>& guard_band_risk = {});

/// Time at which a verdict was made.
enum class JudgedWhen {
  at_end_of_run,
  afterwards,  ///< the run stored no verdict: older program, or a run that was cut off
};
/// Returns the name of the enumerator.
[[nodiscard]] std::string_view to_string(JudgedWhen when);
/// Returns a sentence for a verdict that was made afterwards; otherwise empty.
[[nodiscard]] std::string_view remark_on(JudgedWhen when);

/// Kind of a demand, by its name in verdict.json. bench/judgement/demand_kinds.cpp has a row for each: name, unit, rule
/// of judgement, presentation. The kinds of physical measures are the limits of the table of quantities.
struct DemandKind {
  std::string_view name;
  static const DemandKind acuity;  ///< 75 % acuity at a contrast, [[limits.acuity]]
  /// Requires a threshold with both limits of its interval at every contrast that has no limit on acuity.
  static const DemandKind identified;
  static const DemandKind equivalence;       ///< equivalence to the simulated twin, [limits] equivalence_margin_percent
  static const DemandKind scene_dependence;  ///< dependence of the response on a hot bar, `todbench scene-dependence`
  auto operator<=>(const DemandKind&) const = default;
};
inline constexpr DemandKind DemandKind::acuity{"acuity"}, DemandKind::identified{"identified"},
    DemandKind::equivalence{"equivalence"}, DemandKind::scene_dependence{"scene_dependence"};
/// Returns the name of the kind.
[[nodiscard]] constexpr std::string_view to_string(DemandKind kind) {
  return kind.name;
}

/// Ratio of camera and twin that an equivalence demand uses.
enum class RatioKind {
  unpaired,  ///< ratio of the two thresholds
  paired,    ///< ratio from the phases that camera and twin both observed (tod/comparison/paired_ratio.h)
};
inline constexpr std::array all_ratio_kinds{RatioKind::unpaired, RatioKind::paired};
/// Returns the name of the enumerator.
[[nodiscard]] constexpr std::string_view to_string(RatioKind kind) {
  return kind == RatioKind::paired ? "paired" : "unpaired";
}

/// Risks of a demand given the fleet of the plan (fleet_prior.h).
struct DemandFleet {
  int units = 0;                                ///< number of units of the fleet prior
  double p_conformity = 0;                      ///< probability that the demand is met, given the result and the fleet
  double consumer_risk = 0, producer_risk = 0;  ///< global risks of this rule over the fleet
  /// Largest risks at the estimated standard deviation of the fleet and at both limits of its 95 % interval.
  double consumer_risk_most = 0, producer_risk_most = 0;
};

/// Demand with its result. Unit and words follow from the kind (demand_kinds.h).
struct Demand {
  DemandKind kind = DemandKind::identified;
  std::optional<double> delta_t_k{};  ///< set contrast; empty if the demand is not about one contrast
  std::optional<double> limit{};      ///< empty: the demand has no number
  std::optional<double> result{};
  Interval interval{};        ///< interval that decides
  int interval_percent = 95;  ///< confidence of the interval
  /// Interval from the finite number of trials alone; present if the budget expands the deciding interval.
  std::optional<Interval> statistical{};
  VerdictKind decision = VerdictKind::inconclusive;
  std::string reason{};  ///< a sentence
  /// Decision in the terms of the rule. In `decision`, conditional results are inconclusive. Empty: the demand has no
  /// number.
  std::optional<ConformityDecision> conformity{};
  /// Probability that the demand is met, given the result (decide()). Empty: unknown.
  std::optional<double> p_conformity{};

  std::optional<double> degrees_of_freedom{};  ///< degrees of freedom of the interval; empty: infinite

  /// Risks given the fleet; present if the plan states a fleet row for this demand.
  std::optional<DemandFleet> fleet{};

  std::optional<std::string> zone{};  ///< zone of the frame; empty if the demand does not concern a zone
  std::optional<RatioKind> ratio{};   ///< kind of ratio of an equivalence demand that was judged

  /// Returns the specific risk of a wrong acceptance; empty unless the demand passes.
  [[nodiscard]] std::optional<double> consumer_risk() const;
  /// Returns the specific risk of a wrong rejection; empty unless the demand fails.
  [[nodiscard]] std::optional<double> producer_risk() const;
};

/// Content of verdict.json. judge() makes the verdict once; other code only presents it.
struct Verdict {
  VerdictKind decision = VerdictKind::inconclusive;
  std::string reason{};  ///< reason for the decision, a sentence
  ConformityRule rule = ConformityRule::guarded_acceptance_and_rejection;
  std::string rule_in_words{};
  std::vector<Demand> demands{};
  std::optional<std::string> ended_early{};  ///< reason for an early end of the run
  JudgedWhen judged = JudgedWhen::at_end_of_run;
  /// Rows missing from the budget of the plan; empty: the plan has no budget.
  std::optional<std::vector<std::string>> not_stated{};
};

/// Physical measure of the session, in its unit.
struct MeasuredQuantity {
  std::string measure;  ///< name of the measure in measures.json
  std::optional<double> value{};
  Interval ci95{};
};

/// Input of judge(). The objects to which the input refers must exist during the call.
struct JudgementInput {
  const LimitsPlan& limits;
  const TodCurve& curve;  ///< curve; has no points if the run ended before the first point
  const std::optional<Comparison>& comparison;
  std::optional<std::string> ended_early{};
  bool bench_contradicts = false;  ///< the run ended because the frames contradict plan or target: no demand is decided
  JudgedWhen judged = JudgedWhen::at_end_of_run;
  const CurveUncertainty* uncertainty = nullptr;  ///< uncertainty of the curve; null: the plan has no budget
  /// Transmittance of the bench, if camera and target both state the contrast in kelvin. If the plan then has no
  /// budget, and set and observed contrast differ by more than two standard errors, a limit on an acuity is judged with
  /// an interval that is valid for both contrasts. Empty: the contrasts are not compared.
  std::optional<double> air_transmittance{};
  /// Measures of the camera, or of the simulated sensor alone; empty: none measured.
  std::optional<std::vector<MeasuredQuantity>> measures{};
};

/// Judges all demands. The verdict is fail if one demand fails. Otherwise it is inconclusive if one demand is
/// inconclusive, if there are no results, or if the run ended early, because missing data could change the verdict. In
/// all other cases it is pass. No other code makes this decision.
[[nodiscard]] Verdict judge(const JudgementInput& evidence);

/// Returns whether the judged plan has limits. Without limits a verdict states only whether every threshold was found.
[[nodiscard]] bool limits_asked(const Verdict& verdict);
/// Returns the decision as a word; "not judged" in place of "pass" if the plan has no limits.
[[nodiscard]] std::string_view decision_word(const Verdict& verdict);

/// Returns whether a fit identifies the threshold. This requires a value with both limits of its interval, a slope that
/// is not at its lower bound, and a likelihood without a ridge (fewer sizes than parameters).
[[nodiscard]] bool threshold_identified(const PsychometricFit& fit);

/// Returns the threshold of a fit if threshold_identified(); otherwise empty.
[[nodiscard]] std::optional<double> identified_threshold(const PsychometricFit& fit);

/// Converts a decision; a conditional decision becomes inconclusive.
[[nodiscard]] VerdictKind kind_of(ConformityDecision decision);
/// Converts a decision to the terms of a rule.
[[nodiscard]] ConformityDecision conformity_of(VerdictKind kind);
/// Returns the decision on an equivalence demand.
[[nodiscard]] VerdictKind decision_of(ComparisonVerdict verdict);

/// Returns the exit code: 0 pass, 1 fail, 3 inconclusive.
[[nodiscard]] int exit_code(VerdictKind kind);
/// Returns 0 if the threshold is identified and fit for a decision, otherwise 3.
[[nodiscard]] int exit_code(const PsychometricFit& fit, const Adequacy& adequacy = {});
/// Returns the exit code of an error: 2 for `invalid_input`, 4 for `not_found`, 5 for `disconnected`, `integrity` and
/// `timeout`, 6 for `calibration`, 7 for `io` (for example a full disk) and `internal`, 130 for `interrupted`.
[[nodiscard]] int exit_code(ErrorCode code);

}  // namespace todbench
