// todbench cost
#include <filesystem>
#include <memory>

#include "bench/cli/commands.h"
#include "bench/judgement/verdict.h"
#include "bench/report/cost_figure.h"
#include "bench/report/report.h"
#include "bench/run/report_data.h"
#include "bench/session/cost_record.h"
#include "bench/session/manifest.h"
#include "bench/session/session_folder.h"
#include "bench/studies/cost_study.h"
#include "bench/text/files.h"

namespace todbench {
namespace {

struct CostArguments {
  std::string plan, session, svg;
  double budget_s = 60;
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
  console.text("paired: with the random numbers of a reference of " + std::to_string(frontier.paired_draws) +
               " draws; best: nothing measured is both faster and nearer, standard error included");
}

/// The plan that is named, or that of the session.
Result<LoadedPlan> plan_of(const CostArguments& arguments) {
  if (!arguments.plan.empty() && !arguments.session.empty())
    return fail(ErrorCode::invalid_input, "--session: the plan is that of the session, so no PLAN.toml may be named");
  if (arguments.plan.empty() && arguments.session.empty())
    return fail(ErrorCode::invalid_input, "cost: PLAN.toml or --session is required");
  if (arguments.session.empty()) return read_plan(arguments.plan);
  auto session = read_session(arguments.session);
  if (!session) return tl::unexpected(session.error());
  return LoadedPlan::of(std::move(session->plan), std::move(session->parts));
}

/// cost.json and, from the folder as it then is, the report; the manifest follows both.
Result<void> into_session(const CostFrontier& frontier, const std::filesystem::path& folder) {
  if (auto written = write_file_atomically(folder / "cost.json", to_page(cost_json(frontier))); !written)
    return written;
  const auto session = read_session(folder);
  if (!session) return tl::unexpected(session.error());
  const auto data = report_data(*session, session_name(folder));
  if (!data) return tl::unexpected(data.error());
  if (auto written = write_file_atomically(folder / "report.html", render_report(*data)); !written) return written;
  // A run that was cut off has no manifest.
  std::error_code none;
  if (!std::filesystem::exists(folder / "manifest.json", none)) return {};
  return refresh_manifest(folder, {"cost.json", "report.html"});
}

Result<void> write_results(const CostFrontier& frontier, const CostArguments& arguments) {
  if (!arguments.svg.empty()) {
    const auto document = cost_document(frontier);
    if (!document) return tl::unexpected(document.error());
    if (auto written = write_file_atomically(arguments.svg, *document); !written) return written;
  }
  return arguments.session.empty() ? Result<void>() : into_session(frontier, arguments.session);
}

int run_cost(Console& console, const CostArguments& arguments, const Program& program) {
  auto plan = plan_of(arguments);
  if (!plan) return report_error(console, plan.error());
  if (program.common.seed_given) {
    Plan seeded = plan->plan();
    seeded.seed = program.common.seed;
    plan = plan->with(std::move(seeded));
    if (!plan) return report_error(console, plan.error());
  }
  const CostListener listener{
      .on_phase = [&console](std::string_view phase) { console.phase(phase); },
      .on_progress = [&console](std::size_t done, std::size_t points) { console.progress(done, points); }};
  const auto frontier = cost_of_plan(*plan, arguments.budget_s, listener, program.stop->token());
  console.end_progress();
  if (!frontier) return report_error(console, frontier.error());
  if (console.json()) console.object(cost_json(*frontier));
  if (frontier->reference.empty()) {
    for (const auto& note : frontier->notes) console.note(note);
    console.error("the plan has no identifiable threshold: there is nothing whose error could be measured");
    return exit_code(VerdictKind::inconclusive);
  }
  if (auto written = write_results(*frontier, arguments); !written) return report_error(console, written.error());
  print_cost(console, *frontier);
  for (const auto& note : frontier->notes) console.note(note);
  return 0;
}

}  // namespace

void add_cost_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("cost", "what accuracy costs in time: the frontier, measured on this machine");
  auto a = std::make_shared<CostArguments>();
  command->add_option("PLAN.toml", a->plan, "name or file; or --session");
  command->add_option("--session", a->session,
                      "in place of a plan: measures for that of this session folder, keeps the result there as "
                      "cost.json and rebuilds its report with it");
  command->add_option("--svg", a->svg, "writes the figures to this file");
  command->add_option("--budget-s", a->budget_s, "wall time for all of it; what does not fit is left unmeasured")
      ->check(number_in(0.1, 86400))
      ->capture_default_str();
  finish_command(*command, program, [a, &program](Console& console) { return run_cost(console, *a, program); });
}

}  // namespace todbench
