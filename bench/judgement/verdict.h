// Pass, fail or inconclusive: the limits of a plan against what was measured, as a value that is stored with the
// session, and the exit code of the program.
#pragma once

#include <array>
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

enum class VerdictKind { pass, fail, inconclusive };
[[nodiscard]] std::string_view to_string(VerdictKind kind);

/// How an interval and a limit make a decision: as the plan agreed.
[[nodiscard]] std::string in_words(ConformityRule rule, const std::optional<double>& guard_band_risk = {});

/// When a verdict was made.
enum class JudgedWhen {
  at_end_of_run,
  afterwards,  ///< the run stored none: an older program, or a run that was cut off
};
[[nodiscard]] std::string_view to_string(JudgedWhen when);
/// A sentence for a verdict that its run did not make; empty for one that it made.
[[nodiscard]] std::string_view remark_on(JudgedWhen when);

/// Of which ratio of camera and twin an equivalence is demanded.
enum class RatioKind {
  unpaired,  ///< of two thresholds
  paired,    ///< by the phases that both saw (tod/comparison/paired_ratio.h)
};
inline constexpr std::array all_ratio_kinds{RatioKind::unpaired, RatioKind::paired};
[[nodiscard]] constexpr std::string_view to_string(RatioKind kind) {
  return kind == RatioKind::paired ? "paired" : "unpaired";
}

/// What the fleet of the plan says of a demand (fleet_prior.h).
struct DemandFleet {
  int units = 0;                                          ///< that the fleet is known from
  double p_conformity = 0;                                ///< given the result and the fleet
  double consumer_risk = 0, producer_risk = 0;            ///< global: of this rule over the fleet
  double consumer_risk_most = 0, producer_risk_most = 0;  ///< as far as so many units tell, 95 %
};

/// One demand with what was found. Its unit and its words follow from the kind (demand_kinds.h).
struct Demand {
  DemandKind kind = DemandKind::identified;
  std::optional<double> delta_t_k{};  ///< set contrast; nothing where the demand is not about one contrast
  std::optional<double> limit{};      ///< nothing: the demand is no number
  std::optional<double> result{};
  Interval interval{};        ///< that decides
  int interval_percent = 95;  ///< confidence of the interval
  /// Of the finite number of trials alone, where a budget expands the interval that decides.
  std::optional<Interval> statistical{};
  VerdictKind decision = VerdictKind::inconclusive;
  std::string reason{};  ///< a sentence
  /// The decision in the words of the rule: a conditional one is inconclusive above. Nothing: no number is demanded.
  std::optional<ConformityDecision> conformity{};
  /// Probability that the demand is met, given the result (decide()). Nothing: not known.
  std::optional<double> p_conformity{};

  std::optional<DemandFleet> fleet{};  ///< where the plan states one

  std::optional<std::string> zone{};  ///< of the frame; nothing where the demand is not about one
  std::optional<RatioKind> ratio{};   ///< of a demanded equivalence that could be judged

  /// Specific risks of this decision: of a wrong acceptance where it is to pass, of a wrong rejection where to fail.
  [[nodiscard]] std::optional<double> consumer_risk() const;
  [[nodiscard]] std::optional<double> producer_risk() const;
};

/// verdict.json of a session. Made once, by judge(); everything else shows it.
struct Verdict {
  VerdictKind decision = VerdictKind::inconclusive;
  std::string reason{};  ///< of the decision, a sentence
  ConformityRule rule = ConformityRule::guarded_acceptance_and_rejection;
  std::string rule_in_words{};
  std::vector<Demand> demands{};
  std::optional<std::string> ended_early{};  ///< why the run did
  JudgedWhen judged = JudgedWhen::at_end_of_run;
  /// Rows that the budget of the plan leaves out; nothing: the plan has no budget.
  std::optional<std::vector<std::string>> not_stated{};
};

/// A physical measure of the session, in its unit.
struct MeasuredQuantity {
  std::string measure;  ///< as in measures.json
  std::optional<double> value{};
  Interval ci95{};
};

/// What is judged. Borrows for the call.
struct Evidence {
  const LimitsPlan& limits;
  const TodCurve& curve;  ///< without points where the run ended before there was one
  const std::optional<Comparison>& comparison;
  std::optional<std::string> ended_early{};
  JudgedWhen judged = JudgedWhen::at_end_of_run;
  const CurveUncertainty* uncertainty = nullptr;  ///< of the curve; null: the plan has no budget
  /// Of the camera, or of the simulated sensor alone; nothing: none was measured.
  std::optional<std::vector<MeasuredQuantity>> measures{};
};

/// Judges every kind of demand. The whole fails if one demand fails, is inconclusive if one is, if nothing was measured
/// or if the run ended early (what is missing could have changed it), and passes otherwise. The only place that
/// decides.
[[nodiscard]] Verdict judge(const Evidence& evidence);

/// The plan has limits. Without any a verdict says only whether every threshold was found.
[[nodiscard]] bool limits_asked(const Verdict& verdict);

/// A fit says where the threshold is: it has a point and both sides of its interval, and its slope is not at the lower
/// bound, nor the point one of a ridge (fewer sizes than parameters).
[[nodiscard]] bool threshold_identified(const PsychometricFit& fit);

/// Conditional decisions are inconclusive.
[[nodiscard]] VerdictKind kind_of(ConformityDecision decision);
[[nodiscard]] ConformityDecision conformity_of(VerdictKind kind);
/// A comparison as the answer to a demanded equivalence.
[[nodiscard]] VerdictKind decision_of(ComparisonVerdict verdict);

/// Exit codes: 0 pass, 1 fail, 3 inconclusive.
[[nodiscard]] int exit_code(VerdictKind kind);
/// 0 where the threshold is identified and fit for a decision, else 3.
[[nodiscard]] int exit_code(const PsychometricFit& fit, const Adequacy& adequacy = {});
/// 2 invalid_input, 4 not_found, 5 disconnected, integrity, timeout, 6 calibration, 7 io (a full disk) and internal,
/// 130 interrupted.
[[nodiscard]] int exit_code(ErrorCode code);

}  // namespace todbench
