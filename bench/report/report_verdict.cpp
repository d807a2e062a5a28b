// SPDX-License-Identifier: GPL-3.0-or-later
// The box with the verdict, and the table of limits.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "bench/judgement/demand_kinds.h"
#include "bench/report/fit_words.h"
#include "bench/report/number_format.h"
#include "bench/report/report_pieces.h"

namespace todbench {
namespace {

RichText limit_cell(const Demand& demand) {
  const LimitSide side = row_of(demand.kind).side;
  if (side == LimitSide::none || !demand.limit || !std::isfinite(*demand.limit)) return missing("no limit value");
  const std::string_view unit = row_of(demand.kind).unit;
  return unbroken((side == LimitSide::at_least ? "≥ " : "≤ ") + stated(*demand.limit) +
                  (unit.empty() || unit == "1" ? "" : " " + std::string(unit)));
}

/// The column header states 95 %; another confidence is stated with the number.
RichText result_cell(const Demand& demand) {
  if (demand.interval_percent == 95 || (!demand.interval.low && !demand.interval.high))
    return interval_or_missing(demand.result, demand.interval, "no value");
  return unbroken(with_interval(demand.result, demand.interval) + " (" + std::to_string(demand.interval_percent) +
                  " %)");
}

/// Names conditional decisions, and states the risks of the decision.
RichText conformity_words(const Demand& demand) {
  std::vector<std::string> parts;
  if (demand.conformity == ConformityDecision::conditional_pass ||
      demand.conformity == ConformityDecision::conditional_fail)
    parts.emplace_back(to_string(*demand.conformity));
  std::string risks;
  if (demand.p_conformity) risks = "probability of conformity " + probability(*demand.p_conformity);
  if (const auto risk = demand.consumer_risk()) risks += ", consumer's risk " + probability(*risk);
  if (const auto risk = demand.producer_risk()) risks += ", producer's risk " + probability(*risk);
  if (!risks.empty()) parts.push_back(std::move(risks));
  if (const auto& fleet = demand.fleet) {
    parts.push_back("with the fleet of " + std::to_string(fleet->units) + " earlier units: probability of conformity " +
                    probability(fleet->p_conformity) + "; over the fleet, probability of a wrong acceptance " +
                    probability(fleet->consumer_risk) + " (at most " + probability(fleet->consumer_risk_most) +
                    "), of a wrong rejection " + probability(fleet->producer_risk) + " (at most " +
                    probability(fleet->producer_risk_most) + ")");
  }
  return parts.empty() ? RichText{} : plain(fmt::format("{}", fmt::join(parts, "; ")));
}

/// The reason of a decision and its risks. The reason of a pass is in the columns beside it: interval and limit.
RichText reason_cell(const Demand& demand) {
  const RichText risks = demand.conformity ? conformity_words(demand) : RichText{};
  if (demand.decision == VerdictKind::pass && demand.p_conformity && demand.kind != DemandKind::equivalence)
    return risks;
  RichText reason = text_or_missing(demand.reason, "none given");
  return risks.phrases.empty() ? reason : reason + plain("; ") + risks;
}

/// Returns the result with the interval of the finite number of trials.
RichText statistical_cell(const Demand& demand) {
  Demand alone = demand;
  if (demand.statistical) alone.interval = *demand.statistical;
  return result_cell(alone);
}

struct Headline {
  std::string word, sentence;
  Mood mood = Mood::open;
};

Headline headline(ReportVerdict verdict) {
  switch (verdict) {
    case ReportVerdict::pass:
      return {"✓ PASS", "Every limit is met.", Mood::good};
    case ReportVerdict::fail:
      return {"✗ FAIL", "At least one limit is not met.", Mood::bad};
    case ReportVerdict::inconclusive:
      return {"? INCONCLUSIVE", "No limit is violated, but these data do not decide at least one limit.", Mood::open};
    case ReportVerdict::interrupted:
      return {"? INTERRUPTED", "The run ended early. The results below are partial, so there is no verdict.",
              Mood::open};
    case ReportVerdict::changed:
      return {"✗ FILES CHANGED",
              "Files of this session were changed after the run. The report shows the files as they are now, so there "
              "is no verdict.",
              Mood::bad};
    case ReportVerdict::not_judged:
      break;
  }
  return {"NO VERDICT", "The plan has no limits. This report states results only.", Mood::open};
}

/// Returns the demand on which the decision rests: of those with this decision, the one with the smallest probability
/// of conformity; the first if none has one. Null: no demand decides.
const Demand* deciding_demand(const Verdict& verdict) {
  const Demand* least = nullptr;
  for (const Demand& demand : verdict.demands) {
    if (demand.decision != verdict.decision || demand.kind == DemandKind::identified) continue;
    if (least == nullptr || demand.p_conformity.value_or(1) < least->p_conformity.value_or(1)) least = &demand;
  }
  return least;
}

/// "75 % acuity at 0.23 K: 0.29 [0.28, 0.30] 1/mrad, limit ≥ 0.2"
RichText deciding_words(const Demand& demand) {
  RichText text = plain(title(demand) + ": ") + result_cell(demand);
  if (row_of(demand.kind).side != LimitSide::none && demand.limit) text += plain(", limit ") + limit_cell(demand);
  return text;
}

/// Returns the remark about one interruption of a run, shown with the verdict.
RichText resumption(const Interruption& loss, std::size_t segment) {
  return strong("Interrupted and resumed:") +
         plain(fmt::format(" segment {} begins with presentation {}. The camera was lost for {:.1f} s ({}). It "
                           "returned with the same serial number and settings. The plate had moved by {:.2f} pixels.",
                           segment, loss.presentation, loss.away_s, loss.reason, loss.moved_px));
}

/// "the model observer hvs-1, not a person". The gain of hvs-1 is that of the EO-VISTA experiment.
std::string judge_in_words(const std::string& observer) {
  return "the model observer " + observer +
         (observer.starts_with("hvs-1") ? ", tuned to the gain of the EO-VISTA experiment, not a person"
                                        : ", not a person");
}

}  // namespace

VerdictBox verdict_box(const ReportData& data) {
  const ReportVerdict verdict = report_verdict(data);
  const Headline found = headline(verdict);
  VerdictBox box{found.word, found.mood, {plain(found.sentence)}};
  const bool decided =
      verdict == ReportVerdict::pass || verdict == ReportVerdict::fail || verdict == ReportVerdict::inconclusive;
  if (const Demand* demand = decided && data.verdict ? deciding_demand(*data.verdict) : nullptr)
    box.paragraphs.push_back(strong(verdict == ReportVerdict::pass ? "Closest to its limit:" : "Decided by:") +
                             plain(" ") + deciding_words(*demand));
  if (data.revision)
    box.paragraphs.push_back(
        strong("Revision " + std::to_string(data.revision->number) + " of " + data.revision->utc + ":") +
        plain(" " + data.revision->reason + ". It amends the signed report."));
  for (const std::string& file : data.accepted_changes)
    box.paragraphs.push_back(strong("Changed, removed or added after the session ended:") + plain(" " + file));
  if (data.cut_off)
    box.paragraphs.push_back(strong("Cut off:") +
                             plain(" the run wrote no manifest, so its files cannot be verified."));
  const auto by_a_bar = [](const Demand& demand) { return demand.kind == DemandKind::scene_dependence; };
  if (data.verdict && std::any_of(data.verdict->demands.begin(), data.verdict->demands.end(), by_a_bar))
    box.paragraphs.push_back(strong("Only about a hot bar in the field:") + plain(" " + data.verdict->reason + "."));
  if (verdict != ReportVerdict::not_judged && verdict != ReportVerdict::changed)
    box.paragraphs.push_back(strong("Decision rule:") + plain(" ") +
                             text_or_missing(data.verdict ? data.verdict->rule_in_words : "", "not stated"));
  if (!data.observer.empty())
    box.paragraphs.push_back(strong("Judged by:") + plain(" " + judge_in_words(data.observer)));
  if (data.verdict && data.verdict->judged == JudgedWhen::afterwards)
    box.paragraphs.push_back(plain(remark_on(data.verdict->judged)));
  if (data.interrupted)
    box.paragraphs.push_back(strong("Interrupted:") + plain(" ") +
                             text_or_missing(*data.interrupted, "no reason recorded"));
  for (std::size_t i = 0; i < data.interruptions.size(); ++i)
    box.paragraphs.push_back(resumption(data.interruptions[i], i + 2));
  return box;
}

Section limits_section(const ReportData& data) {
  Section section{"Limits", {}};
  if (!data.verdict || !limits_asked(*data.verdict))
    section.blocks.emplace_back(Paragraph{missing("the plan has no limits")});
  if (!data.verdict || data.verdict->demands.empty()) return section;
  const auto& demands = data.verdict->demands;
  const bool expanded =
      std::any_of(demands.begin(), demands.end(), [](const Demand& demand) { return demand.statistical.has_value(); });
  Table rows;
  // Decisions in changed files are not verdicts.
  const bool believed = report_verdict(data) != ReportVerdict::changed;
  rows.header = {"Quantity", "Limit", expanded ? "Result [expanded 95 %]" : "Result [95 %]",
                 believed ? "Verdict" : "Decision in the files", "Reason"};
  if (expanded) rows.header.insert(rows.header.begin() + 3, "Statistical [95 %]");
  for (const Demand& demand : demands) {
    const std::string decision(to_string(demand.decision));
    rows.rows.push_back({plain(title(demand)), limit_cell(demand), result_cell(demand),
                         believed ? badge(decision, mood_of(demand.decision)) : plain(decision), reason_cell(demand)});
    if (expanded) rows.rows.back().insert(rows.rows.back().begin() + 3, statistical_cell(demand));
  }
  section.blocks.emplace_back(std::move(rows));
  if (data.verdict->not_stated && !data.verdict->not_stated->empty()) {
    section.blocks.emplace_back(Paragraph{
        plain(fmt::format("The budget of the plan does not state: {}.", fmt::join(*data.verdict->not_stated, ", ")))});
  }
  section.blocks.emplace_back(note(plain(one_sided_note)));
  return section;
}

}  // namespace todbench
