// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/run_results.h"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "bench/cli/effect_decisions.h"
#include "bench/cli/exit_codes.h"
#include "bench/cli/findings.h"
#include "bench/judgement/demand_kinds.h"
#include "bench/judgement/verdict_record.h"
#include "bench/session/fit_record.h"
#include "bench/session/measure_pictures.h"
#include "bench/session/measures_record.h"
#include "bench/session/uncertainty_record.h"
#include "bench/text/json_fields.h"
#include "bench/text/text.h"
#include "tod/psychometric/acuity.h"
#include "tod/psychometric/contrast_slope.h"

namespace todbench {
namespace {

/// "2.0911 ± 0.0016": a direct estimate with its standard error.
std::string with_error(const std::optional<double>& value, const std::optional<double>& se) {
  const std::string text = fixed(value, 4);
  return value && se ? text + " ± " + fixed(*se, 4) : text;
}

void print_comparison(const Console& console, const ExperimentOutcome& outcome) {
  std::vector<TableRow> rows;
  for (std::size_t i = 0; i < outcome.comparison->points.size(); ++i) {
    const auto& c = outcome.comparison->points[i];
    const TodPoint* real = point_at(outcome.curve, c.set_delta_t_k);
    const TodPoint* twin = point_at(*outcome.twin, c.set_delta_t_k);
    rows.push_back({fixed(c.delta_t_a_k, 3), real != nullptr ? fixed(stated_acuity_per_mrad(real->fit), 4) : "–",
                    real != nullptr ? range(acuity_interval(real->fit.ci95), 4) : "–",
                    twin != nullptr ? fixed(stated_acuity_per_mrad(twin->fit), 4) : "–",
                    twin != nullptr ? range(acuity_interval(twin->fit.ci95), 4) : "–", fixed(c.ratio, 3),
                    range(c.ratio_ci95, 3), std::string(to_string(c.verdict))});
  }
  console.table(
      {"dT [K]", "acuity measured [1/mrad]", "95 %", "simulated [1/mrad]", "95 %", "ratio", "95 %", "verdict"}, rows);
  print_paired(console, *outcome.comparison, has_contrast_measured_once(outcome.curve));
}

/// Prints the verdict, unless the run ended early. Thresholds without a limit are in the table of the curve.
void print_verdict(const Console& console, const ExperimentOutcome& outcome) {
  if (outcome.ended_by) return;
  const Verdict& verdict = outcome.verdict;
  std::vector<std::string> lines;
  for (const Demand& demand : verdict.demands) {
    if (demand.kind == DemandKind::identified && demand.decision == VerdictKind::pass) continue;
    lines.push_back(std::string(to_string(demand.decision)) + ": " + in_words(demand) +
                    (demand.reason.empty() ? "" : "; " + demand.reason));
  }
  if (!lines.empty()) console.text("");
  for (const std::string& line : lines) console.text(line);
  console.text("");
  console.text("verdict: " + std::string(to_string(verdict.decision)) +
               (lines.empty() ? " (" + verdict.reason + ")" : ""));
}

/// Adds what stands beside the results for an observer with an eye.
void add_display(Json& json, const ExperimentOutcome& outcome) {
  if (!outcome.at_display) return;
  if (auto record = json_of(*outcome.at_display, display_fields)) json["at_display"] = *std::move(record);
}

void print_display(const Console& console, const ExperimentOutcome& outcome) {
  if (!outcome.at_display) return;
  for (const DisplayedPoint& point : outcome.at_display->points) {
    console.text(outcome.at_display->observer + " at the display, " + number_text(point.delta_t_k) + " K: S75 " +
                 fixed(point.s75_mrad, 4) + " mrad");
  }
  for (const AcuityLimits& limits : outcome.at_display->limits) console.text(in_words(limits));
}

/// Adds physical measures, if the plan requests them.
void add_measures(Json& json, const ExperimentOutcome& outcome) {
  if (!outcome.measures && !outcome.twin_measures) return;
  Json measures = measures_json(outcome.measures, outcome.twin_measures);
  static_cast<void>(take_pictures(measures));  // the pictures are in the session
  json["measures"] = std::move(measures);
}

void print_measures(const Console& console, const ExperimentOutcome& outcome) {
  if (!outcome.measures) return;
  const MeasureLines main = measure_lines(*outcome.measures);
  const MeasureLines twin = outcome.twin_measures ? measure_lines(*outcome.twin_measures) : MeasureLines{};
  std::vector<TableRow> rows;
  for (const MeasureLine& line : main.lines) {
    const auto other = std::find_if(twin.lines.begin(), twin.lines.end(),
                                    [&](const MeasureLine& l) { return l.measure == line.measure; });
    rows.push_back({line.measure, line.unit, fixed(line.value, 4), range(line.ci95, 4),
                    other == twin.lines.end() ? "–" : fixed(other->value, 4)});
  }
  if (rows.empty()) return;
  console.text("");
  console.table({"measure", "unit", "value", "95 %", "twin"}, rows);
}

/// Prints statistical and expanded interval side by side, and the dominant row.
void print_uncertainty(const Console& console, const ExperimentOutcome& outcome) {
  if (!outcome.uncertainty) return;
  std::vector<TableRow> rows;
  for (const PointUncertainty& point : outcome.uncertainty->points) {
    const auto largest =
        std::max_element(point.rows.begin(), point.rows.end(),
                         [](const AppliedRow& a, const AppliedRow& b) { return a.contribution < b.contribution; });
    rows.push_back({fixed(point.set_delta_t_k, 3), fixed(point.contrast_slope, 3),
                    range(acuity_interval(point.statistical_mrad), 4), range(acuity_interval(point.expanded_mrad), 4),
                    point.combined ? fixed(100 * point.combined->u, 2) : "–",
                    largest == point.rows.end() ? "–" : largest->row.name});
  }
  console.text("");
  console.table({"dT set [K]", "d ln acuity / d ln dT", "acuity, statistical 95 % [1/mrad]", "expanded 95 % [1/mrad]",
                 "u [%]", "largest contribution"},
                rows);
  std::string missing;
  for (const std::string& name : outcome.uncertainty->not_stated) missing += (missing.empty() ? "" : ", ") + name;
  if (!missing.empty()) console.text("not stated in the budget: " + missing);
}

/// Prints what the time of the run bought.
void print_bill(const Console& console, const AccuracyBill& bill) {
  const bool forecast = bill.forecast_s.has_value();
  std::vector<TableRow> rows;
  for (const BillRow& row : bill.rows) {
    rows.push_back({row.part, fixed(row.seconds, 1), row.bought});
    if (forecast) rows.back().insert(rows.back().begin() + 2, row.forecast_s ? fixed(row.forecast_s, 1) : "");
  }
  rows.push_back({"total", fixed(bill.total_s, 1), ""});
  if (forecast) rows.back().insert(rows.back().begin() + 2, fixed(bill.forecast_s, 1));
  TableRow header{"part of the run", "time [s]", "result"};
  if (forecast) header.insert(header.begin() + 2, "forecast [s]");
  console.text("");
  console.table(header, rows);
  for (const std::string& sentence : bill.sentences) console.text(sentence);
}

}  // namespace

void print_curve(const Console& console, const TodCurve& curve) {
  std::vector<TableRow> rows;
  for (const auto& point : curve.points) {
    rows.push_back({fixed(point.delta_t_k, 3), fixed(stated_threshold(point.fit), 4), range(point.fit.ci95, 4),
                    fixed(stated_acuity_per_mrad(point.fit), 4), range(acuity_interval(point.fit.ci95), 4),
                    with_error(point.direct_s75_mrad, point.direct_s75_se_mrad), fixed(point.fit.trials, 0),
                    std::string(to_string(point.fit.verdict))});
  }
  console.text("TOD of " + curve.sensor + ", observer " + curve.observer);
  console.table({"dT [K]", "S75 [mrad]", "95 %", "acuity [1/mrad]", "95 %", "S75 direct ± SE [mrad]", "trials", "fit"},
                rows);
  for (const auto& point : curve.points) {
    if (!point.s75_spread_mrad) continue;
    console.text(fixed(point.set_delta_t_k, 3) + " K: S75 " + fixed(point.s75_spread_mrad->first, 4) + " to " +
                 fixed(point.s75_spread_mrad->second, 4) +
                 " mrad over the open parameters of the observer (a range of the model, not a confidence interval)");
  }
  for (const auto& point : curve.points)
    print_findings(console, point.adequacy, fixed(point.set_delta_t_k, 3) + " K: ");
}

AccuracyBill bill_of(const ExperimentOutcome& outcome) {
  return accuracy_bill({.presentations = outcome.presentations,
                        .curve = outcome.curve,
                        .uncertainty = outcome.uncertainty ? &*outcome.uncertainty : nullptr,
                        .verdict = &outcome.verdict,
                        .effects = outcome.effects,
                        .wall_s = outcome.figures.wall_s,
                        .measures_s = outcome.figures.measures_s,
                        .quantities = outcome.measures ? measure_lines(*outcome.measures).lines.size() : 0,
                        .forecast = outcome.forecast ? &*outcome.forecast : nullptr,
                        .twin_s = outcome.twin_s});
}

void add_verdict(Json& json, const Verdict& verdict) {
  json["verdict"] = to_string(verdict.decision);
  json["judgement"] = verdict_json(verdict);
}

int finish_run(Console& console, const ExperimentOutcome& outcome) {
  console.note("session: " + outcome.folder.string());
  if (outcome.ended_by) {
    console.error("ended early: " + outcome.ended_by->message + "; the trials so far are in " +
                  outcome.folder.string());
    return exit_code(outcome.ended_by->code);
  }
  return exit_code(outcome.verdict.decision);
}

void print_run(const Console& console, const ExperimentOutcome& outcome, const RunShown& shown) {
  if (shown.curve) print_curve(console, outcome.curve);
  if (shown.effects) {
    console.text("");
    print_effect_table(console, outcome.effects, shown.why);
  }
  if (outcome.comparison) {
    if (shown.curve) console.text("");
    print_comparison(console, outcome);
  }
  print_uncertainty(console, outcome);
  print_measures(console, outcome);
  print_display(console, outcome);
  print_bill(console, bill_of(outcome));
  print_verdict(console, outcome);
}

int show_run(Console& console, const ExperimentOutcome& outcome, const RunShown& shown) {
  if (console.json()) {
    Json json = curve_json(outcome.curve, outcome.effects, outcome.figures);
    if (outcome.uncertainty) add_uncertainty(json, *outcome.uncertainty);
    add_verdict(json, outcome.verdict);
    json["bill"] = bill_json(bill_of(outcome));
    add_measures(json, outcome);
    add_display(json, outcome);
    console.object(json);
  } else {
    print_run(console, outcome, shown);
  }
  return finish_run(console, outcome);
}

}  // namespace todbench
