// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/sweep_engines.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <vector>

#include "acquisition/base/process.h"
#include "acquisition/base/try.h"
#include "bench/cli/commands.h"
#include "bench/sweep/schedulers.h"
#include "bench/sweep/task_plan.h"
#include "bench/text/files.h"
#include "bench/text/folders.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

Result<std::vector<std::string>> site_options(const std::string& file) {
  if (file.empty()) return std::vector<std::string>{};
  TODBENCH_TRY(const auto text, read_text_file(file));
  return site_options_from(text, file);
}

Result<std::string> text_for(const SweepArguments& a, Scheduler scheduler, std::size_t tasks) {
  TODBENCH_TRY(const auto options, site_options(a.options_file));
  const JobList jobs{
      .program = a.program, .sweep_file = a.file, .tasks = tasks, .chunk = std::max<std::size_t>(a.chunk, 1)};
  return job_text(scheduler, jobs, options);
}

/// Warns before submission of an array that most sites reject.
void note_long_array(Console& console, const SweepArguments& a, std::size_t tasks) {
  constexpr std::size_t usual_limit = 1000;  // MaxArraySize is 1001 by default
  const std::size_t chunk = std::max<std::size_t>(a.chunk, 1), jobs = (tasks + chunk - 1) / chunk;
  if (jobs <= usual_limit) return;
  console.note(fmt::format(
      "the job array has {} elements; by default Slurm accepts at most {} (MaxArraySize). --chunk {} keeps this limit",
      jobs, usual_limit, (tasks + usual_limit - 1) / usual_limit));
}

/// Runs sbatch on a script. Returns its exit code; an error if it cannot be started.
Result<int> submitted(const std::string& script, bool shown) {
  const Descriptor discarded = shown ? Descriptor() : null_device();
  const auto process = start_program({"sbatch", script}, {.output = discarded.get()});
  const auto code = process ? wait_for_program(*process) : Result<int>(tl::unexpected(process.error()));
  constexpr int not_there = 127;
  if (code && *code != not_there) return code;
  return fail(ErrorCode::not_found, "sbatch cannot be started; the script is in " + script);
}

}  // namespace

int print_tasks(Console& console, const SweepArguments& a) {
  const auto runnable = load_sweep(a.file);
  if (!runnable) return report_error(console, runnable.error());
  const auto scheduler = std::find_if(all_schedulers.begin(), all_schedulers.end(),
                                      [&](Scheduler s) { return to_string(s) == a.scheduler; });
  const auto text = text_for(a, *scheduler, runnable->sweep.count());
  if (!text) return report_error(console, text.error());
  if (*scheduler == Scheduler::slurm) note_long_array(console, a, runnable->sweep.count());
  if (console.json()) {
    console.object({{"for", a.scheduler}, {"tasks", runnable->sweep.count()}, {"text", *text}});
    return 0;
  }
  std::string_view rest = *text;
  while (!rest.empty()) {
    const auto end = std::min(rest.find('\n'), rest.size());
    console.text(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return 0;
}

int submit_to_slurm(Console& console, SweepArguments a) {
  const auto runnable = load_sweep(a.file);
  if (!runnable) return report_error(console, runnable.error());
  std::error_code problem;
  a.file = std::filesystem::absolute(a.file, problem).string();
  if (a.program == "todbench") a.program = own_program();
  const auto text = text_for(a, Scheduler::slurm, runnable->sweep.count());
  if (!text) return report_error(console, text.error());
  note_long_array(console, a, runnable->sweep.count());
  const auto script = runnable->sweep.file().results / "slurm.sh";
  if (auto made = make_folder(script.parent_path()); !made) return report_error(console, made.error());
  if (auto written = write_file_atomically(script, *text); !written) return report_error(console, written.error());
  if (!a.dry_run) {
    const auto code = submitted(script.string(), !console.json());
    if (!code) return report_error(console, code.error());
    if (*code != 0)
      return report_error(console, {ErrorCode::not_found, fmt::format("sbatch ended with exit code {}", *code)});
  }
  if (console.json()) console.object({{"engine", a.engine}, {"script", script.string()}, {"submitted", !a.dry_run}});
  console.text((a.dry_run ? "written, not submitted: " : "submitted: ") + script.string());
  return 0;
}

}  // namespace todbench
