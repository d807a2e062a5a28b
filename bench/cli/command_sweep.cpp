// SPDX-License-Identifier: GPL-3.0-or-later
// todbench sweep
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <utility>

#include "acquisition/base/process.h"
#include "acquisition/base/try.h"
#include "bench/cli/commands.h"
#include "bench/cli/sweep_engines.h"
#include "bench/judgement/verdict.h"
#include "bench/report/html.h"
#include "bench/sweep/processes.h"
#include "bench/sweep/result_store.h"
#include "bench/sweep/schedulers.h"
#include "bench/sweep/sweep_effects.h"
#include "bench/sweep/sweep_page.h"
#include "bench/sweep/sweep_table.h"
#include "bench/text/files.h"
#include "bench/text/folders.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

/// Indices from `first` to `last`, both included.
struct IndexRange {
  std::size_t first = 0, last = 0;
};

std::optional<std::size_t> index_from(const std::string& text) {
  const auto value = parse_number(text);
  if (!value || *value < 0 || *value > 1e9 || *value != std::floor(*value)) return std::nullopt;
  return static_cast<std::size_t>(*value);
}

/// Parses "3-17" or "3".
Result<IndexRange> range_from(const std::string& text) {
  const auto dash = text.find('-');
  const auto first = index_from(text.substr(0, dash));
  const auto last = dash == std::string::npos ? first : index_from(text.substr(dash + 1));
  if (!first || !last || *last < *first)
    return fail(ErrorCode::invalid_input, "--range: expected FIRST-LAST, found '" + one_line(text) + "'");
  return IndexRange{*first, *last};
}

/// Indices of chunk `number`; they may exceed the number of tasks.
IndexRange chunk_of(std::size_t number, std::size_t chunk) {
  return {number * chunk, number * chunk + chunk - 1};
}

/// Parameters as JSON, with numbers as numbers, like the table of the results.
Json parameters_json(const SweepTask& task) {
  Json json = Json::object();
  for (const auto& [key, value] : task.parameters) {
    const auto number = parse_number(value);
    json[key] = number ? Json(*number) : Json(value);
  }
  return json;
}

/// Returns a chunk of 15 minutes: schedulers prefer jobs of 5 to 30 minutes.
std::size_t suggested_chunk(double task_s, std::size_t tasks) {
  constexpr double wanted_s = 900;
  return std::clamp<std::size_t>(static_cast<std::size_t>(wanted_s / std::max(task_s, 1e-3)), 1,
                                 std::max<std::size_t>(tasks, 1));
}

int run_expand(Console& console, const SweepArguments& a, const Program& program) {
  const auto runnable = load_sweep(a.file);
  if (!runnable) return report_error(console, runnable.error());
  const Sweep& sweep = runnable->sweep;
  std::optional<double> task_s;
  if (a.predict) {
    const auto predicted = predicted_task_s(*runnable, sweep.task(0), program.stop->token());
    if (!predicted) return report_error(console, predicted.error());
    task_s = *predicted;
  }
  // Every task is expanded as it will run; different names mean different tasks.
  Json tasks = Json::array();
  for (std::size_t i = 0; i < sweep.count(); ++i) {
    const SweepTask task = sweep.task(i);
    if (a.list)
      tasks.push_back({{"index", i},
                       {"task", task.name},
                       {"seed", task.seed},
                       {"repeat", task.repeat},
                       {"parameters", parameters_json(task)}});
  }
  const std::size_t chunk = task_s ? suggested_chunk(*task_s, sweep.count()) : 0;
  Json json{{"tasks", sweep.count()},
            {"refused", sweep.refused()},
            {"keys", sweep.keys()},
            {"sweep_sha256", sweep.hash()},
            {"results", sweep.file().results.string()},
            {"predicted_task_s", json_number(task_s)},
            {"suggested_chunk", chunk > 0 ? Json(chunk) : Json()}};
  if (a.list) json["list"] = std::move(tasks);
  if (console.json()) {
    console.object(json);
    return 0;
  }
  console.text(fmt::format("{} tasks, {} combinations excluded by a condition; results in {}", sweep.count(),
                           sweep.refused(), sweep.file().results.string()));
  if (const SweepFile& file = sweep.file(); file.sample_total)
    console.text(fmt::format("total-effect indices: {} draws of {} parameters need {} x {} combinations",
                             file.sample_count, file.sample.size(), file.sample_count, file.sample.size() + 2));
  if (task_s) {
    console.text(fmt::format("about {:.3g} s per task, {:.3g} h on one core; a job of {} tasks takes about 15 minutes",
                             *task_s, *task_s * static_cast<double>(sweep.count()) / 3600, chunk));
  }
  if (a.list) {
    for (const auto& task : json["list"])
      console.text(task["task"].get<std::string>() + " " + to_line(task["parameters"]));
  }
  return 0;
}

/// Outcomes of the tasks of one process.
struct Counts {
  std::size_t done = 0, already_done = 0, failed = 0, locked = 0;
  std::optional<Error> first_failure;
};

Counts run_range_of_tasks(Console& console, const RunnableSweep& runnable, IndexRange range, std::stop_token stop) {
  Counts counts;
  const std::size_t last = std::min(range.last, runnable.sweep.count() - 1);
  for (std::size_t i = range.first; i <= last && !stop.stop_requested(); ++i) {
    const TaskOutcome outcome = run_and_store(runnable, i, stop);
    switch (outcome.kind) {
      case TaskOutcome::Kind::done:
        ++counts.done;
        break;
      case TaskOutcome::Kind::already_done:
        ++counts.already_done;
        break;
      case TaskOutcome::Kind::locked:
        ++counts.locked;
        console.error(fmt::format("task {} is being run by another process", i));
        break;
      case TaskOutcome::Kind::failed:
        ++counts.failed;
        if (!counts.first_failure) counts.first_failure = outcome.error;
        if (outcome.error->code != ErrorCode::interrupted)
          console.error(fmt::format("task {}: {}", i, outcome.error->message));
        break;
    }
    console.progress(i + 1 - range.first, last + 1 - range.first);
  }
  console.end_progress();
  return counts;
}

/// Returns the exit code; that of a busy device if another process holds tasks: none failed, but some are open.
int code_of(const Counts& counts, std::stop_token stop) {
  if (stop.stop_requested()) return exit_code(ErrorCode::interrupted);
  if (counts.first_failure) return exit_code(counts.first_failure->code);
  return counts.locked > 0 ? exit_code(ErrorCode::not_found) : 0;
}

/// Tasks named by the command line or the environment; empty: all.
Result<std::optional<IndexRange>> named_range(Console& console, const SweepArguments& a) {
  const std::size_t chunk = std::max<std::size_t>(a.chunk, 1);
  if (!a.range.empty()) {
    TODBENCH_TRY(auto range, range_from(a.range));
    return std::optional(range);
  }
  if (a.index) return std::optional(chunk_of(*a.index, chunk));
  if (a.jobs) return std::nullopt;
  const auto found = index_from_environment();
  if (!found) {
    if (a.chunk == 0) return std::nullopt;
    return fail(
        ErrorCode::invalid_input,
        "--chunk is the number of tasks per index, but no index is given: add --index or set it in the environment");
  }
  console.note(fmt::format("{} sets the index {}", found->variable, found->index));
  return std::optional(chunk_of(found->index, chunk));
}

/// Runs several processes; each takes the next range when it is free.
Result<int> run_in_processes(Console& console, const SweepArguments& a, const Sweep& sweep, std::stop_token stop) {
  const std::size_t tasks = sweep.count();
  const ProcessPool pool{.tasks = tasks,
                         .jobs = *a.jobs,
                         .chunk = a.chunk > 0 ? a.chunk : std::clamp<std::size_t>(tasks / (*a.jobs * 8), 1, 500),
                         .command =
                             [&](std::size_t first, std::size_t last) {
                               return std::vector<std::string>{
                                   own_program(), "sweep", "run", a.file, "--range", fmt::format("{}-{}", first, last),
                                   "--quiet"};
                             },
                         .on_progress = [&](std::size_t done) { console.progress(done, tasks); }};
  const auto code = run_pool(pool, std::move(stop));
  console.end_progress();
  return code;
}

Json status_json(const Sweep& sweep) {
  const SweepStatus status = sweep_status(sweep);
  Json failures = Json::array();
  constexpr std::size_t most_failures = 100;
  for (std::size_t i = 0; i < status.states.size() && failures.size() < most_failures; ++i) {
    if (status.states[i] == TaskState::failed) failures.push_back({{"index", i}, {"reason", failure_of(sweep, i)}});
  }
  return {{"tasks", status.states.size()},
          {"done", status.count(TaskState::done)},
          {"failed", status.count(TaskState::failed)},
          {"running", status.count(TaskState::running)},
          {"stale", status.count(TaskState::stale)},
          {"missing", status.count(TaskState::missing)},
          {"foreign", status.count(TaskState::foreign)},
          {"open", status.open_list()},
          {"failures", failures}};
}

int run_sweep(Console& console, const SweepArguments& a, const Program& program) {
  const auto runnable = load_sweep(a.file);
  if (!runnable) return report_error(console, runnable.error());
  const auto range = named_range(console, a);
  if (!range) return report_error(console, range.error());
  const auto stop = program.stop->token();
  if (*range && (*range)->first >= runnable->sweep.count()) {
    return report_error(console, {ErrorCode::invalid_input,
                                  fmt::format("index {} is too large: the sweep has {} tasks, numbered from 0",
                                              (*range)->first, runnable->sweep.count())});
  }
  console.phase("running " + runnable->sweep.file().name);
  if (!*range && a.jobs.value_or(1) > 1) {
    const auto code = run_in_processes(console, a, runnable->sweep, stop);
    if (!code) return report_error(console, code.error());
    const Json json = status_json(runnable->sweep);
    if (console.json()) console.object(json);
    console.text(fmt::format("{} of {} tasks have a result", json["done"].get<std::size_t>(), runnable->sweep.count()));
    return *code;
  }
  const IndexRange all{0, runnable->sweep.count() - 1};
  const Counts counts = run_range_of_tasks(console, *runnable, range->value_or(all), stop);
  if (console.json()) {
    console.object({{"run", counts.done},
                    {"already_done", counts.already_done},
                    {"failed", counts.failed},
                    {"locked", counts.locked},
                    {"results", runnable->sweep.file().results.string()}});
  }
  console.text(fmt::format("tasks: {} run, {} with a result from before, {} failed, {} locked by other processes",
                           counts.done, counts.already_done, counts.failed, counts.locked));
  return code_of(counts, stop);
}

int run_status(Console& console, const SweepArguments& a) {
  const auto runnable = load_sweep(a.file);
  if (!runnable) return report_error(console, runnable.error());
  const Json json = status_json(runnable->sweep);
  if (console.json()) {
    console.object(json);
    return 0;
  }
  std::vector<TableRow> rows;
  for (const char* key : {"tasks", "done", "failed", "running", "stale", "missing", "foreign"})
    rows.push_back({key, std::to_string(json[key].get<std::size_t>())});
  console.table({"state", "tasks"}, rows);
  if (const auto open = json["open"].get<std::string>(); !open.empty()) console.text("open: " + open);
  for (const auto& failure : json["failures"])
    console.text(fmt::format("task {}: {}", failure["index"].get<std::size_t>(), failure["reason"].get<std::string>()));
  return 0;
}

int run_submit(Console& console, SweepArguments a, const Program& program) {
  if (a.engine == "local") {
    if (!a.jobs) a.jobs = 2;
    return run_sweep(console, a, program);
  }
  return submit_to_slurm(console, std::move(a));
}

int run_collect(Console& console, const SweepArguments& a) {
  const auto runnable = load_sweep(a.file);
  if (!runnable) return report_error(console, runnable.error());
  const auto table = collected(runnable->sweep, a.partial ? MissingTasks::left_out : MissingTasks::refused);
  if (!table) return report_error(console, table.error());
  const auto folder = runnable->sweep.file().results;
  if (auto made = make_folder(folder); !made) return report_error(console, made.error());
  const std::string csv = a.csv.empty() ? (folder / "table.csv").string() : a.csv;
  const std::string sqlite = a.sqlite.empty() ? (folder / "table.sqlite").string() : a.sqlite;
  if (auto written = write_file_atomically(csv, to_csv(*table)); !written)
    return report_error(console, written.error());
  if (auto written = write_sqlite(*table, sqlite); !written) return report_error(console, written.error());
  const bool identifies = runnable->sweep.file().kind == TaskKind::identify;
  const std::string usual = identifies ? "r75_m" : "acuity_per_mrad";
  const auto effects = sweep_effects(runnable->sweep, *table, a.response.empty() ? usual : a.response);
  if (!a.page.empty()) {
    const std::string page = render_html(sweep_page(runnable->sweep, *table, effects));
    if (auto written = write_file_atomically(a.page, page); !written) return report_error(console, written.error());
  }
  if (console.json()) {
    Json json = to_json(*table);
    json["effects"] = to_json(effects);
    console.object(json);
    return 0;
  }
  console.text(fmt::format("{} rows of {} tasks written to {} and {}", table->rows.size(),
                           table->tasks - table->missing, csv, sqlite));
  for (const auto& response : effects) {
    std::vector<TableRow> rows;
    for (const auto& effect : response.parameters)
      rows.push_back({effect.key, fixed(effect.first_order, 3), range(effect.first_order_ci95, 3),
                      fixed(effect.total, 3), range(effect.total_ci95, 3)});
    console.text("variance of " + response.response +
                 (identifies ? "" : fmt::format(" at a contrast of {:g} K", response.delta_t_k)));
    console.table({"parameter", "first-order index", "95 %", "total-effect index", "95 %"}, rows);
  }
  return 0;
}

CLI::App* add_part(CLI::App& sweep, const std::string& name, const std::string& what,
                   const std::shared_ptr<SweepArguments>& a) {
  auto* part = sweep.add_subcommand(name, what);
  part->add_option("SWEEP.toml", a->file, "sweep file")->required();
  return part;
}

void add_chunk(CLI::App& part, const std::shared_ptr<SweepArguments>& a) {
  part.add_option("--chunk", a->chunk, "number of tasks per index")->check(whole_number(1, 10000000));
}

void add_run_parts(CLI::App& sweep, Program& program, const std::shared_ptr<SweepArguments>& a) {
  auto* expand = add_part(sweep, "expand", "counts the tasks of a sweep, or lists them", a);
  expand->add_flag("--list", a->list, "lists every task with its parameters and seed");
  expand->add_flag("--predict", a->predict, "predicts the time per task and suggests a chunk size");
  finish_command(*expand, program, [a, &program](Console& console) { return run_expand(console, *a, program); });
  auto* run = add_part(sweep, "run", "runs tasks that have no result yet", a);
  run->add_option("--index", a->index, "index of the task, from 0; with --chunk: index of the chunk")
      ->check(whole_number(0, 1000000000));
  run->add_option("--range", a->range, "runs the tasks FIRST-LAST, both included");
  run->add_option("--jobs", a->jobs, "number of parallel processes")->check(whole_number(1, 1024));
  add_chunk(*run, a);
  finish_command(*run, program, [a, &program](Console& console) { return run_sweep(console, *a, program); });
  auto* status = add_part(sweep, "status", "counts the tasks that are done, failed, running or missing", a);
  finish_command(*status, program, [a](Console& console) { return run_status(console, *a); });
}

}  // namespace

void add_sweep_command(CLI::App& app, Program& program) {
  auto* sweep =
      app.add_subcommand("sweep", "runs a simulation over many parameters, on this computer or on a scheduler");
  sweep->require_subcommand(1);
  auto a = std::make_shared<SweepArguments>();
  add_run_parts(*sweep, program, a);
  auto* tasks = add_part(*sweep, "tasks", "prints the task list for a scheduler without submitting it", a);
  tasks->add_option("--for", a->scheduler, "scheduler: parallel, slurm, gridengine, snakemake or make")
      ->check(CLI::IsMember({"parallel", "slurm", "gridengine", "snakemake", "make"}))
      ->capture_default_str();
  tasks->add_option("--program", a->program, "command that starts todbench on the computers of the scheduler")
      ->capture_default_str();
  tasks->add_option("--options", a->options_file, "file with scheduler options of the site, one per line");
  add_chunk(*tasks, a);
  finish_command(*tasks, program, [a](Console& console) { return print_tasks(console, *a); });
  auto* submit = add_part(*sweep, "submit", "submits the tasks to a scheduler, or runs them on this computer", a);
  submit->add_option("--engine", a->engine, "where the tasks run: local (on this computer) or slurm")
      ->check(CLI::IsMember({"local", "slurm"}))
      ->capture_default_str();
  submit->add_option("--options", a->options_file, "file with sbatch options of the site, one per line");
  submit->add_option("--jobs", a->jobs, "local: number of parallel processes")->check(whole_number(1, 1024));
  submit->add_option("--program", a->program,
                     "command that starts todbench on the computers of the scheduler; default: this program");
  submit->add_flag("--dry-run", a->dry_run, "writes the script without submitting it");
  add_chunk(*submit, a);
  finish_command(*submit, program, [a, &program](Console& console) { return run_submit(console, *a, program); });
  auto* collect = add_part(*sweep, "collect", "collects all results in one table, as CSV and SQLite", a);
  collect->add_option("--csv", a->csv, "file for the table; default: table.csv beside the results");
  collect->add_option("--sqlite", a->sqlite, "file for the database; default: table.sqlite beside the results");
  collect->add_option("--page", a->page, "file for a page with tables and figures of the response; default: no page");
  collect->add_option("--response", a->response,
                      "column whose dependence on the parameters is computed; default: acuity_per_mrad, or r75_m of "
                      "sweeps of kind identify");
  collect->add_flag("--partial", a->partial, "skips tasks without a result; by default they are an error");
  finish_command(*collect, program, [a](Console& console) { return run_collect(console, *a); });
}

}  // namespace todbench
