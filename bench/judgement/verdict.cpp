// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/judgement/verdict.h"

#include <algorithm>

#include "bench/judgement/demand_kinds.h"
#include "bench/judgement/fleet_prior.h"
#include "bench/text/text.h"

namespace todbench {

namespace {

bool any(const Verdict& verdict, VerdictKind decision) {
  return std::any_of(verdict.demands.begin(), verdict.demands.end(),
                     [&](const Demand& demand) { return demand.decision == decision; });
}

struct Decided {
  VerdictKind decision;
  std::string reason;
};

Decided decided(const Verdict& verdict, const TodCurve& curve) {
  if (any(verdict, VerdictKind::fail)) return {VerdictKind::fail, "at least one demand is not met"};
  if (verdict.ended_early) return {VerdictKind::inconclusive, "the run ended early: " + *verdict.ended_early};
  if (curve.points.empty()) return {VerdictKind::inconclusive, "no contrast was measured"};
  if (any(verdict, VerdictKind::inconclusive))
    return {VerdictKind::inconclusive, "no demand is violated, but these data do not decide at least one demand"};
  if (!limits_asked(verdict)) return {VerdictKind::pass, "the plan has no limits, and every threshold was identified"};
  return {VerdictKind::pass, "every demand is met"};
}

/// Withdraws the decision about a demand.
void withhold(Demand& demand) {
  demand.decision = VerdictKind::inconclusive;
  if (demand.conformity) demand.conformity = ConformityDecision::inconclusive;
  demand.p_conformity.reset();
  demand.reason =
      "not decided, because the frames contradict the plan or the target; without this contradiction: " + demand.reason;
}

/// Returns "; the intervals do not include the uncertainty of distance, form", or an empty text.
std::string without(const Verdict& verdict) {
  if (!verdict.not_stated || verdict.not_stated->empty()) return {};
  std::string names;
  for (const std::string& name : *verdict.not_stated) names += (names.empty() ? "" : ", ") + name;
  return "; the intervals do not include the uncertainty of " + names;
}

}  // namespace

std::string_view to_string(VerdictKind kind) {
  switch (kind) {
    case VerdictKind::pass:
      return "pass";
    case VerdictKind::fail:
      return "fail";
    case VerdictKind::inconclusive:
      return "inconclusive";
  }
  return "";
}

std::string in_words(ConformityRule rule, const std::optional<double>& guard_band_risk) {
  const std::string band = guard_band_risk ? "a guard band that leaves a risk of " + number_text(*guard_band_risk) +
                                                 " of a wrong acceptance at the acceptance limit"
                                           : "the 95 % confidence interval as guard band";
  switch (rule) {
    case ConformityRule::guarded_acceptance_and_rejection:
      if (guard_band_risk)
        return "Guarded acceptance and guarded rejection with " + band +
               " (after ILAC-G8:09/2019): pass if the result meets the limit by at least the guard band, fail if it "
               "misses the limit by more than the guard band, otherwise inconclusive. The result is also inconclusive "
               "if the threshold cannot be identified.";
      return "Guarded acceptance and guarded rejection with the 95 % confidence interval as guard band (after "
             "ILAC-G8:09/2019): pass if the whole interval meets the limit, fail if the whole interval misses it, "
             "inconclusive if the limit lies within the interval or the threshold cannot be identified.";
    case ConformityRule::simple:
      return "Simple acceptance (ILAC-G8:09/2019, 4.2.1): pass if the result meets the limit, otherwise fail. A result "
             "at the limit is wrongly accepted or rejected with a probability of up to 50 %.";
    case ConformityRule::guarded:
      return "Guarded acceptance with " + band +
             " (ILAC-G8:09/2019, 4.2.2): pass if the result meets the limit by at least the guard band, otherwise "
             "fail.";
    case ConformityRule::non_binary:
      return "Non-binary with " + band +
             " (ILAC-G8:09/2019, 4.2.3): pass if the result meets the limit by at least the guard band, fail if it "
             "misses the limit by more than the guard band. Between them the result is a conditional pass or a "
             "conditional fail, which the verdict counts as inconclusive.";
  }
  return "";
}

std::string_view to_string(JudgedWhen when) {
  switch (when) {
    case JudgedWhen::at_end_of_run:
      return "at_end_of_run";
    case JudgedWhen::afterwards:
      return "afterwards";
  }
  return "";
}

std::string_view remark_on(JudgedWhen when) {
  switch (when) {
    case JudgedWhen::at_end_of_run:
      return "";
    case JudgedWhen::afterwards:
      return "The run of this session stored no verdict. The session was judged afterwards, by the limits of its plan.";
  }
  return "";
}

std::optional<double> Demand::consumer_risk() const {
  return decision == VerdictKind::pass && p_conformity ? std::optional(1 - *p_conformity) : std::nullopt;
}

std::optional<double> Demand::producer_risk() const {
  return decision == VerdictKind::fail ? p_conformity : std::nullopt;
}

bool threshold_identified(const PsychometricFit& fit) {
  return fit.threshold && fit.ci95.low && fit.ci95.high && fit.verdict != FitVerdict::flat_or_decreasing &&
         fit.verdict != FitVerdict::underdetermined && fit.verdict != FitVerdict::no_data;
}

std::optional<double> identified_threshold(const PsychometricFit& fit) {
  return threshold_identified(fit) ? fit.threshold : std::nullopt;
}

bool limits_asked(const Verdict& verdict) {
  return std::any_of(verdict.demands.begin(), verdict.demands.end(),
                     [](const Demand& demand) { return demand.kind != DemandKind::identified; });
}

std::string_view decision_word(const Verdict& verdict) {
  const bool nothing_to_judge = verdict.decision == VerdictKind::pass && !limits_asked(verdict);
  return nothing_to_judge ? "not judged" : to_string(verdict.decision);
}

Verdict judge(const JudgementInput& evidence) {
  const LimitsPlan& limits = evidence.limits;
  Verdict verdict{.rule = limits.rule,
                  .rule_in_words = in_words(limits.rule, limits.guard_band_risk),
                  .ended_early = evidence.ended_early,
                  .judged = evidence.judged};
  for (const DemandKindRow& row : demand_kinds()) {
    for (Demand& demand : row.judge(row, evidence)) verdict.demands.push_back(std::move(demand));
  }
  if (evidence.bench_contradicts) {
    for (Demand& demand : verdict.demands) withhold(demand);
  }
  add_fleet_risks(verdict.demands, limits);
  if (evidence.uncertainty != nullptr) verdict.not_stated = evidence.uncertainty->not_stated;
  auto [decision, reason] = decided(verdict, evidence.curve);
  verdict.decision = decision;
  verdict.reason = std::move(reason) + without(verdict);
  return verdict;
}

VerdictKind kind_of(ConformityDecision decision) {
  if (decision == ConformityDecision::pass) return VerdictKind::pass;
  return decision == ConformityDecision::fail ? VerdictKind::fail : VerdictKind::inconclusive;
}

ConformityDecision conformity_of(VerdictKind kind) {
  switch (kind) {
    case VerdictKind::pass:
      return ConformityDecision::pass;
    case VerdictKind::fail:
      return ConformityDecision::fail;
    case VerdictKind::inconclusive:
      break;
  }
  return ConformityDecision::inconclusive;
}

VerdictKind decision_of(ComparisonVerdict verdict) {
  switch (verdict) {
    case ComparisonVerdict::equivalent:
      return VerdictKind::pass;
    case ComparisonVerdict::different:
      return VerdictKind::fail;
    case ComparisonVerdict::inconclusive:
      return VerdictKind::inconclusive;
  }
  return VerdictKind::inconclusive;
}

int exit_code(VerdictKind kind) {
  switch (kind) {
    case VerdictKind::pass:
      return 0;
    case VerdictKind::fail:
      return 1;
    case VerdictKind::inconclusive:
      return 3;
  }
  return 7;
}

int exit_code(const PsychometricFit& fit, const Adequacy& adequacy) {
  return threshold_identified(fit) && adequacy.adequate() ? 0 : 3;
}

int exit_code(ErrorCode code) {
  switch (code) {
    case ErrorCode::invalid_input:
      return 2;
    case ErrorCode::not_found:
      return 4;
    case ErrorCode::disconnected:
    case ErrorCode::integrity:
    case ErrorCode::timeout:
      return 5;
    case ErrorCode::not_identifiable:
      return 3;
    case ErrorCode::calibration:
      return 6;
    case ErrorCode::interrupted:
      return 130;
    case ErrorCode::io:
    case ErrorCode::internal:
      return 7;
  }
  return 7;
}

}  // namespace todbench
