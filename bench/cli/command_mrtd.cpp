// SPDX-License-Identifier: GPL-3.0-or-later
// todbench mrtd
#include "bench/cli/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>

#include "acquisition/base/try.h"
#include "bench/cli/chain_options.h"
#include "bench/cli/effect_decisions.h"
#include "bench/judgement/verdict.h"
#include "bench/report/html.h"
#include "bench/report/svg.h"
#include "bench/studies/mrtd_study.h"
#include "bench/text/files.h"
#include "bench/text/spread_text.h"

namespace todbench {
namespace {

struct MrtdArguments {
  ChainOptions chain;
  std::string criterion = "four-or-five", axis = "both", page, svg;
  std::vector<double> frequencies_per_mrad, of_nyquist{0.2, 0.4, 0.6, 0.8, 0.9, 1.0, 1.2};
  int draws = 2000;
  double range_m = 0;
  FormulaConditions formula{};
  EffectDecisionOptions decisions;
};

Result<MrtdStudyTask> mrtd_task(const MrtdArguments& a, const Program& program) {
  MrtdStudyTask task;
  TODBENCH_TRY(auto chain, a.chain.load());
  if (a.range_m == 0 && chain.air.name != "clear")
    return fail(ErrorCode::invalid_input, "--atmosphere needs the length of the path: add --range-m");
  task.range_m = a.range_m;
  task.air = std::move(chain.air);
  task.trial.sensor = std::move(chain.sensor);
  task.trial.plan = full_plan(task.trial.sensor, {}, {});
  task.trial.observer = std::move(chain.observer);
  task.trial.accuracy = chain.accuracy;
  for (const BarCriterion known : {BarCriterion::four_or_five, BarCriterion::bars_resolved, BarCriterion::detection}) {
    if (a.criterion == to_string(known)) task.trial.criterion = known;
  }
  task.trial.draws = a.draws;
  task.trial.seed = program.common.seed;
  task.trial.stop = program.stop->token();
  task.trial.frequencies_per_mrad = a.frequencies_per_mrad;
  if (a.frequencies_per_mrad.empty()) {
    const double nyquist = 0.5 * task.trial.sensor.samples_per_pitch() / task.trial.sensor.ifov_mrad();
    for (const double share : a.of_nyquist) task.trial.frequencies_per_mrad.push_back(share * nyquist);
  }
  if (a.axis != "vertical") task.axes.push_back(BarAxis::horizontal);
  if (a.axis != "horizontal") task.axes.push_back(BarAxis::vertical);
  task.formula = a.formula;
  return task;
}

std::optional<double> sampling_spread(const VirtualMrtdPoint& point) {
  if (!point.best_phase_k || !point.worst_phase_k) return std::nullopt;
  return *point.worst_phase_k / *point.best_phase_k;
}

Json point_json(const MrtdStudyPoint& point) {
  const VirtualMrtdPoint& found = point.found;
  Json json{{"frequency_per_mrad", json_number(found.frequency_per_mrad)},
            {"frequency_over_nyquist", json_number(found.frequency_over_nyquist)},
            {"mrtd_k", json_number(point.mrtd_k)},
            {"reason", point.reason.empty() ? Json() : Json(point.reason)},
            {"threshold_k", json_number(found.threshold_k)},
            {"threshold_ci95_k", json_interval(point.threshold_ci95_k)},
            {"best_phase_k", json_number(found.best_phase_k)},
            {"worst_phase_k", json_number(found.worst_phase_k)},
            {"sampling_spread", json_number(sampling_spread(found))},
            {"highest_k", json_number(found.highest_k)},
            {"proportion_at_highest", json_number(found.proportion_at_most)},
            {"formula_mrtd_k", json_number(point.formula_k)},
            {"ideal_k", json_number(found.ideal_k)},
            {"modulation_best", json_number(found.modulation_best)},
            {"modulation_worst", json_number(found.modulation_worst)},
            {"share_of_phases_with_four_bars", json_number(found.share_of_four)}};
  // Of an observer with an eye, over its open parameters; no confidence interval.
  add_spread(json, "threshold_spread_k", found.spread_k);
  return json;
}

Json mrtd_json(const MrtdStudyTask& task, const MrtdStudy& study) {
  Json axes = Json::object();
  for (const auto& curve : study.curves) {
    Json points = Json::array();
    for (const auto& point : curve.points) points.push_back(point_json(point));
    axes[curve.axis == BarAxis::horizontal ? "horizontal" : "vertical"] = points;
  }
  return {{"sensor", task.trial.sensor.name},
          {"samples_per_pitch", task.trial.sensor.samples_per_pitch()},
          {"observer", task.trial.observer.name},
          {"criterion", std::string(to_string(task.trial.criterion))},
          {"draws", task.trial.draws},
          {"nyquist_per_mrad", json_number(study.nyquist_per_mrad)},
          {"range_m", task.range_m > 0 ? json_number(task.range_m) : Json()},
          {"transmittance", json_number(study.transmittance)},
          {"atmosphere", {{"name", task.air.name}, {"source", task.air.source}}},
          {"formula",
           {{"snr_threshold", task.formula.snr_threshold}, {"eye_integration_s", task.formula.eye_integration_s}}},
          {"axes", axes}};
}

void print_mrtd(Console& console, const MrtdStudyTask& task, const MrtdStudy& study) {
  console.text("virtual MRTD of " + task.trial.sensor.name + ", observer " + task.trial.observer.name + ", " +
               std::string(to_string(task.trial.criterion)));
  if (task.range_m > 0) {
    console.text(fmt::format("contrasts of the bars at a range of {:g} m; transmittance {:.4f}", task.range_m,
                             study.transmittance));
  }
  for (const auto& curve : study.curves) {
    std::vector<TableRow> rows;
    for (const auto& p : curve.points) {
      rows.push_back({fixed(p.found.frequency_per_mrad, 3), fixed(p.found.frequency_over_nyquist, 2),
                      fixed(p.mrtd_k, 4), range(p.mrtd_k ? p.threshold_ci95_k : Interval{}, 4),
                      fixed(p.found.best_phase_k, 4), fixed(p.found.worst_phase_k, 4), fixed(p.formula_k, 4),
                      p.reason});
      if (task.trial.observer.eye) {
        const auto& spread = p.found.spread_k;
        rows.back().insert(rows.back().begin() + 4,
                           spread ? fixed(spread->first, 4) + " to " + fixed(spread->second, 4) : std::string("-"));
      }
    }
    console.text("");
    console.text(curve.axis == BarAxis::horizontal ? "horizontal axis" : "vertical axis");
    TableRow header{"f [/mrad]",      "f/Nyquist",       "MRTD [K]",    "95 %",
                    "best phase [K]", "worst phase [K]", "formula [K]", "reason"};
    if (task.trial.observer.eye) header.insert(header.begin() + 4, "spread, open parameters [K]");
    console.table(header, rows);
  }
}

int run_mrtd(Console& console, const MrtdArguments& a, const Program& program) {
  const auto task = mrtd_task(a, program);
  if (!task) return report_error(console, task.error());
  for (const auto& sentence : task->air.notes) console.note(sentence);
  const DecidedEffects effects{task->trial.sensor.name, task->trial.plan, no_criterion_for("the threshold of bars")};
  if (a.decisions.dry_run) return dry_run(console, {effects}, a.decisions);
  console.phase("simulating the MRTD");
  const auto study = study_mrtd(*task);
  console.end_progress();
  if (!study) return report_error(console, study.error());
  if (!a.svg.empty()) {
    const auto figure = drawn(mrtd_plot(*task, *study));
    if (!figure) return report_error(console, figure.error());
    if (auto written = write_file_atomically(a.svg, svg_document(std::array{*figure})); !written)
      return report_error(console, written.error());
  }
  if (!a.page.empty()) {
    if (auto written = write_file_atomically(a.page, render_html(mrtd_page(*task, *study))); !written)
      return report_error(console, written.error());
  }
  if (console.json()) {
    Json json = mrtd_json(*task, *study);
    add_effects(json, effects);
    console.object(json);
  } else {
    print_mrtd(console, *task, *study);
    print_effects(console, effects, a.decisions);
  }
  // Frequencies beyond Nyquist have no MRTD by rule; any other requested frequency without a threshold is inconclusive.
  const bool all = std::all_of(study->curves.begin(), study->curves.end(), [](const auto& curve) {
    return std::all_of(curve.points.begin(), curve.points.end(), [](const auto& point) {
      return point.found.threshold_k || point.found.frequency_over_nyquist > 1 + 1e-9;
    });
  });
  return exit_code(all ? VerdictKind::pass : VerdictKind::inconclusive);
}

}  // namespace

void add_mrtd_command(CLI::App& app, Program& program) {
  auto* command =
      app.add_subcommand("mrtd", "predicts the MRTD of a simulated camera: the observer judges four-bar targets");
  auto a = std::make_shared<MrtdArguments>();
  a->chain.add_sensor_to(*command);
  a->chain.add_to(*command, "observer: name or file");
  command
      ->add_option("--range-m", a->range_m,
                   "distance from the camera to the bars in m; default: no atmosphere between them")
      ->check(number_in(1e-3, 1e6, "m"));
  command
      ->add_option("--criterion", a->criterion,
                   "task of the observer: four-or-five (two-interval forced choice, free of bias), bars-resolved (yes "
                   "or no) or detection (not an MRTD)")
      ->check(CLI::IsMember({"four-or-five", "bars-resolved", "detection"}))
      ->capture_default_str();
  command->add_option("--axis", a->axis, "axis across which the bars are resolved: horizontal, vertical or both")
      ->check(CLI::IsMember({"horizontal", "vertical", "both"}))
      ->capture_default_str();
  auto* absolute =
      command
          ->add_option("--frequencies-per-mrad", a->frequencies_per_mrad,
                       "spatial frequencies in cycles per mrad, separated by commas; default: those of --of-nyquist")
          ->delimiter(',')
          ->check(number_in(1e-6, 1e6));
  command
      ->add_option(
          "--of-nyquist", a->of_nyquist,
          "spatial frequencies as fractions of the Nyquist frequency, separated by commas; default: 0.2 to 1.2")
      ->delimiter(',')
      ->check(number_in(1e-3, 4))
      ->excludes(absolute);
  command->add_option("--draws", a->draws, "noise draws per frequency; more draws narrow the intervals")
      ->check(whole_number(64, 100000))
      ->capture_default_str();
  command
      ->add_option("--snr-threshold", a->formula.snr_threshold,
                   "signal-to-noise ratio at threshold in the MRTD formula")
      ->check(number_in(1e-6, 1e6))
      ->capture_default_str();
  command
      ->add_option("--eye-integration-s", a->formula.eye_integration_s,
                   "integration time of the eye in the MRTD formula, in s")
      ->check(number_in(1e-4, 10, "s"))
      ->capture_default_str();
  a->decisions.add_to(*command);
  command->add_option("--svg", a->svg, "writes the figure to this SVG file");
  command->add_option("--page", a->page, "writes figure and tables to this HTML file");
  finish_command(*command, program, [a, &program](Console& console) { return run_mrtd(console, *a, program); });
}

}  // namespace todbench
