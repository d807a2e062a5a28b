// todbench cost
#include <algorithm>
#include <cstdio>
#include <memory>

#include "bench/cli/commands.h"
#include "bench/report/cost_figure.h"
#include "bench/run/experiment_inputs.h"
#include "bench/session/files.h"
#include "bench/session/plan_options.h"
#include "sim_devices/prediction/cost_frontier.h"
#include "tod/test_pattern.h"

namespace todbench {
namespace {

struct CostArguments {
  std::string plan, svg;
};

Json cost_json(const CostFrontier& frontier) {
  Json points = Json::array();
  for (const CostPoint& point : frontier.points) {
    points.push_back({{"knob", point.knob},
                      {"setting", point.setting},
                      {"wall_s", json_number(point.wall_s)},
                      {"error_percent", json_number(point.error_percent)},
                      {"standard_error_percent", json_number(point.standard_error_percent)},
                      {"chosen", point.chosen},
                      {"best", point.best}});
  }
  return {{"reference",
           {{"wall_s", json_number(frontier.reference_s)},
            {"standard_error_percent", json_number(frontier.reference_standard_error_percent)}}},
          {"points", points}};
}

void print_cost(const Console& console, const CostFrontier& frontier) {
  std::vector<TableRow> rows;
  for (const CostPoint& point : frontier.points) {
    rows.push_back({point.knob, point.setting, fixed(point.wall_s, 3), fixed(point.error_percent, 3),
                    fixed(point.standard_error_percent, 2),
                    std::string(point.chosen ? "chosen" : "") + (point.chosen && point.best ? ", " : "") +
                        (point.best ? "best" : "")});
  }
  console.table({"knob", "setting", "time [s]", "error of acuity [%]", "standard error [%]", ""}, rows);
  console.text("");
  console.text("reference: " + fixed(frontier.reference_s, 1) + " s, standard error " +
               fixed(frontier.reference_standard_error_percent, 2) +
               " %; best: nothing measured is both faster and nearer to it");
}

Result<CostTask> cost_task(const Plan& plan) {
  auto inputs = read_inputs(plan);
  if (!inputs) return tl::unexpected(inputs.error());
  auto sensor = sensor_of(plan);
  if (!sensor) return tl::unexpected(sensor.error());
  CostTask task;
  task.sensor = *sensor;
  task.full = full_plan(*sensor, {}, {});
  task.planned = inputs->effects;
  task.observer = inputs->observer;
  task.motion = inputs->motion;
  for (const double contrast : plan.target.delta_t_k) task.delta_t_k.push_back(std::abs(contrast));
  task.chosen = inputs->accuracy;
  task.chosen_setting = plan.simulation.accuracy;
  task.seed = plan.seed;
  return task;
}

Result<void> write_figure(const CostFrontier& frontier, const std::string& path) {
  std::vector<CostMark> marks;
  for (const CostPoint& point : frontier.points)
    marks.push_back({point.knob, std::max(point.wall_s, 1e-6), point.error_percent, point.chosen});
  const auto document = svg_document(cost_plot(marks));
  if (!document) return tl::unexpected(document.error());
  return write_file_atomically(path, *document);
}

int run_cost(Console& console, const CostArguments& arguments, const Program& program) {
  auto plan = load_plan(arguments.plan);
  if (!plan) return report_error(console, plan.error());
  if (program.common.seed_given) plan->seed = program.common.seed;
  const auto task = cost_task(*plan);
  if (!task) return report_error(console, task.error());
  console.phase("measuring what accuracy costs");
  const auto frontier = cost_frontier(
      *task, [&console](std::size_t done, std::size_t steps) { console.progress(done, steps); }, program.stop->token());
  console.end_progress();
  if (!frontier) return report_error(console, frontier.error());
  if (!arguments.svg.empty()) {
    if (auto written = write_figure(*frontier, arguments.svg); !written) return report_error(console, written.error());
  }
  if (console.json()) {
    console.object(cost_json(*frontier));
  } else {
    print_cost(console, *frontier);
  }
  return 0;
}

}  // namespace

void add_cost_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("cost", "what accuracy costs in time: the frontier, measured on this machine");
  auto a = std::make_shared<CostArguments>();
  command->add_option("PLAN.toml", a->plan, "name or file")->required();
  command->add_option("--svg", a->svg, "writes the figure to this file");
  finish_command(*command, program, [a, &program](Console& console) { return run_cost(console, *a, program); });
}

}  // namespace todbench
