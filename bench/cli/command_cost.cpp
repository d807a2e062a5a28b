// SPDX-License-Identifier: GPL-3.0-or-later
// todbench cost
#include <filesystem>
#include <memory>

#include "acquisition/base/try.h"
#include "bench/cli/commands.h"
#include "bench/cli/findings.h"
#include "bench/cli/seeded_plan.h"
#include "bench/cli/session_argument.h"
#include "bench/judgement/verdict.h"
#include "bench/report/cost_figure.h"
#include "bench/run/rebuild_report.h"
#include "bench/session/cost_record.h"
#include "bench/session/foreign_files.h"
#include "bench/session/signature.h"
#include "bench/studies/cost_study.h"
#include "bench/text/files.h"
#include "bench/text/json_fields.h"

namespace todbench {
namespace {

struct CostArguments {
  std::string plan, session, svg;
  double budget_s = 60;
  Opening opening{};
};

void print_cost(const Console& console, const CostFrontier& frontier) {
  std::vector<TableRow> rows;
  for (const CostPoint& point : frontier.points) {
    std::string remark = point.not_measured.empty() ? "" : "not measured: " + point.not_measured;
    if (point.best) remark = "best";
    if (point.chosen) remark = remark.empty() ? "chosen" : "chosen, " + remark;
    rows.push_back({point.knob, point.setting, fixed(point.wall_s, 3), fixed(point.error_percent, 3),
                    point.paired ? "paired" : fixed(point.standard_error_percent, 2), remark});
  }
  console.table({"knob", "setting", "time [s]", "error of acuity [%]", "standard error [%]", ""}, rows);
  console.text("");
  console.text("reference: " + std::to_string(frontier.reference_draws) + " draws per size, " +
               fixed(frontier.reference_s, 1) + " s, standard error " +
               fixed(frontier.reference_standard_error_percent, 2) + " %; spent " + fixed(frontier.spent_s, 0) +
               " s of the budget of " + fixed(frontier.budget_s, 0) + " s");
  console.text("paired: with the same random numbers as a reference of " + std::to_string(frontier.paired_draws) +
               " draws; best: no measured setting is both faster and more accurate, standard error included");
}

struct CostPlan {
  LoadedPlan plan;
  std::vector<std::string> accepted_changes{};  ///< of the session
};

/// Returns the named plan, or that of the session.
Result<CostPlan> plan_of(Console& console, const CostArguments& arguments) {
  if (!arguments.plan.empty() && !arguments.session.empty())
    return fail(ErrorCode::invalid_input, "--session already provides the plan: omit either PLAN.toml or --session");
  if (arguments.plan.empty() && arguments.session.empty())
    return fail(ErrorCode::invalid_input, "cost: PLAN.toml or --session is required");
  if (arguments.session.empty()) {
    TODBENCH_TRY(auto plan, read_plan(arguments.plan));
    return CostPlan{std::move(plan)};
  }
  if (auto open = require_unsigned(arguments.session); !open) return tl::unexpected(open.error());
  // Check now, before the costs are measured, that they can be written.
  TODBENCH_TRY_VOID(require_no_links(arguments.session));
  TODBENCH_TRY(auto session, opened(console, arguments.session, arguments.opening));
  TODBENCH_TRY(auto plan, LoadedPlan::of(std::move(session.plan), std::move(session.parts)));
  return CostPlan{std::move(plan), std::move(session.accepted_changes)};
}

/// Writes cost.json, then the report from the present folder, then the manifest. The files may have changed while the
/// costs were measured.
Result<void> into_session(const CostFrontier& frontier, const std::filesystem::path& folder, const Opening& opening) {
  TODBENCH_TRY_VOID(require_unsigned(folder));
  TODBENCH_TRY_VOID(opening.accept_changed ? require_no_links(folder) : require_no_foreign_file(folder));
  TODBENCH_TRY(auto session, open_session(folder, opening));
  TODBENCH_TRY_VOID(write_json_file(folder / "cost.json", cost_json(frontier)));
  if (session.accepted_changes.empty()) {
    if (auto listed = refresh_manifest(folder, {"cost.json"}); !listed) return listed;
    TODBENCH_TRY(session.manifest_sha256, manifest_digest(folder));
  }
  session.cost = frontier;
  TODBENCH_TRY_VOID(rebuild_report(session, folder, html_page(folder)));
  return {};
}

Result<void> write_results(const CostFrontier& frontier, const CostArguments& arguments) {
  if (!arguments.svg.empty()) {
    TODBENCH_TRY(const auto document, cost_document(frontier));
    TODBENCH_TRY_VOID(write_file_atomically(arguments.svg, document));
  }
  if (arguments.session.empty()) return {};
  return into_session(frontier, arguments.session, arguments.opening);
}

/// Precision frontier of the plan: frames and graded answers against bench time.
Result<std::vector<PrecisionChoice>> precision_of(const LoadedPlan& loaded, std::stop_token stop) {
  EffectPlanner planner;
  TODBENCH_TRY(const auto inputs, experiment_inputs(loaded, planner));
  return precision_frontier(loaded.plan(), inputs, std::move(stop));
}

int run_cost(Console& console, const CostArguments& arguments, const Program& program) {
  const auto asked = plan_of(console, arguments);
  if (!asked) return report_error(console, asked.error());
  const auto plan = with_seed(asked->plan, program.common);
  if (!plan) return report_error(console, plan.error());
  const CostListener listener{
      .on_phase = [&console](std::string_view phase) { console.phase(phase); },
      .on_progress = [&console](std::size_t done, std::size_t points) { console.progress(done, points); }};
  const auto frontier = cost_of_plan(*plan, arguments.budget_s, listener, program.stop->token());
  console.end_progress();
  if (!frontier) return report_error(console, frontier.error());
  const auto precision = precision_of(*plan, program.stop->token());
  if (!precision && precision.error().code == ErrorCode::interrupted) return report_error(console, precision.error());
  if (console.json()) {
    auto json = cost_json(*frontier);
    if (!json) return report_error(console, json.error());
    // The frontier is printed only, not stored in the session, so it is left out for a session.
    if (precision && arguments.session.empty()) (*json)["frontier"] = frontier_json(*precision);
    add_accepted_changes(*json, arguments.opening, asked->accepted_changes);
    console.object(*json);
  }
  if (frontier->reference.empty()) {
    for (const auto& note : frontier->notes) console.note(note);
    console.error("the plan has no identifiable threshold, so no error can be measured");
    return exit_code(VerdictKind::inconclusive);
  }
  if (auto written = write_results(*frontier, arguments); !written) return report_error(console, written.error());
  print_cost(console, *frontier);
  if (precision) print_frontier(console, *precision);
  for (const auto& note : frontier->notes) console.note(note);
  return 0;
}

}  // namespace

void add_cost_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("cost", "measures the time that accuracy costs on this machine");
  auto a = std::make_shared<CostArguments>();
  command->add_option("PLAN.toml", a->plan, "plan: name or file; required without --session");
  command->add_option("--session", a->session,
                      "uses the plan of this session folder, stores the result there as cost.json and rebuilds the "
                      "report");
  command->add_option("--svg", a->svg, "writes the figures to this SVG file");
  command
      ->add_option("--budget-s", a->budget_s,
                   "wall time of the whole study in s; settings that do not fit are not measured")
      ->check(number_in(0.1, 86400, "s"))
      ->capture_default_str();
  add_accept_changed(*command, a->opening.accept_changed);
  finish_command(*command, program, [a, &program](Console& console) { return run_cost(console, *a, program); });
}

}  // namespace todbench
