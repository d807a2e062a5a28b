// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/sweep/schedulers.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <optional>

#include "bench/text/text.h"

namespace todbench {
namespace {

std::string command(const JobList& jobs) {
  return shell_word(jobs.program) + " sweep run " + shell_word(jobs.sweep_file) + " --quiet";
}

std::string marked(std::string_view mark, const std::vector<std::string>& options) {
  std::string text;
  for (const auto& option : options) text += fmt::format("{} {}\n", mark, option);
  return text;
}

/// "--range 100-149" of a job.
std::string range_of(const JobList& jobs, std::size_t job) {
  const std::size_t first = job * jobs.chunk, last = std::min(first + jobs.chunk, jobs.tasks) - 1;
  return fmt::format("--range {}-{}", first, last);
}

/// One thread per task, because parallel processes are more efficient.
constexpr std::string_view one_thread = "export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1\n";

std::string parallel_text(const JobList& jobs) {
  std::string text;
  for (std::size_t job = 0; job < jobs.jobs(); ++job) text += command(jobs) + " " + range_of(jobs, job) + "\n";
  return text;
}

std::string slurm_text(const JobList& jobs, const std::vector<std::string>& options) {
  return fmt::format("#!/bin/bash\n#SBATCH --array=0-{}\n#SBATCH --requeue\n{}{}exec {} --chunk {}\n", jobs.jobs() - 1,
                     marked("#SBATCH", options), one_thread, command(jobs), jobs.chunk);
}

std::string gridengine_text(const JobList& jobs, const std::vector<std::string>& options) {
  return fmt::format("#!/bin/bash\n#$ -S /bin/bash\n#$ -cwd\n#$ -t 1-{}\n{}{}exec {} --chunk {}\n", jobs.jobs(),
                     marked("#$", options), one_thread, command(jobs), jobs.chunk);
}

std::string snakemake_text(const JobList& jobs) {
  return fmt::format(
      "rule all:\n    input: expand(\"sweep-jobs/{{job}}.done\", job=range({}))\n\nrule job:\n    output: "
      "\"sweep-jobs/{{job}}.done\"\n    shell: r\"\"\"{} --chunk {} --index {{wildcards.job}} && touch "
      "{{output}}\"\"\"\n",
      jobs.jobs(), command(jobs), jobs.chunk);
}

std::string make_text(const JobList& jobs) {
  std::string name = command(jobs);
  // Escapes the dollar sign for make.
  for (std::size_t i = 0; (i = name.find('$', i)) != std::string::npos; i += 2) name.insert(i, 1, '$');
  return fmt::format(
      "jobs := $(shell seq 0 {})\nall: $(jobs:%=sweep-jobs/%.done)\nsweep-jobs/%.done:\n\tmkdir -p sweep-jobs\n\t{} "
      "--chunk {} --index $*\n\ttouch $@\n.PHONY: all\n",
      jobs.jobs() - 1, name, jobs.chunk);
}

std::optional<std::size_t> whole(const char* text) {
  if (text == nullptr) return std::nullopt;
  const std::string_view view(text);
  std::size_t value = 0;
  const auto [end, problem] = std::from_chars(view.data(), view.data() + view.size(), value);
  return problem == std::errc() && end == view.data() + view.size() ? std::optional(value) : std::nullopt;
}

}  // namespace

std::string_view to_string(Scheduler scheduler) {
  switch (scheduler) {
    case Scheduler::parallel:
      return "parallel";
    case Scheduler::slurm:
      return "slurm";
    case Scheduler::gridengine:
      return "gridengine";
    case Scheduler::snakemake:
      return "snakemake";
    case Scheduler::make:
      return "make";
  }
  return "";
}

std::string shell_word(std::string_view text) {
  const bool plain = !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("_-./+=:,@").find(c) != std::string_view::npos;
  });
  if (plain) return std::string(text);
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string job_text(Scheduler scheduler, const JobList& jobs, const std::vector<std::string>& site_options) {
  switch (scheduler) {
    case Scheduler::parallel:
      return parallel_text(jobs);
    case Scheduler::slurm:
      return slurm_text(jobs, site_options);
    case Scheduler::gridengine:
      return gridengine_text(jobs, site_options);
    case Scheduler::snakemake:
      return snakemake_text(jobs);
    case Scheduler::make:
      return make_text(jobs);
  }
  return "";
}

Result<std::vector<std::string>> site_options_from(std::string_view text, std::string_view file) {
  std::vector<std::string> options;
  for (int line = 1; !text.empty(); ++line) {
    const auto end = std::min(text.find('\n'), text.size());
    std::string_view option = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    while (!option.empty() && (option.back() == ' ' || option.back() == '\r' || option.back() == '\t'))
      option.remove_suffix(1);
    while (!option.empty() && (option.front() == ' ' || option.front() == '\t')) option.remove_prefix(1);
    if (option.empty() || option.front() == '#') continue;
    if (option.front() != '-') {
      return fail(
          ErrorCode::invalid_input,
          fmt::format("{}:{}: expected an option such as --partition=short, found '{}'", file, line, one_line(option)));
    }
    options.emplace_back(option);
  }
  return options;
}

Result<EnvironmentIndex> index_from_environment() {
  struct Source {
    const char* variable;
    std::size_t first;
  };
  for (const auto& [variable, first] :
       {Source{"SLURM_ARRAY_TASK_ID", 0}, Source{"SGE_TASK_ID", 1}, Source{"PBS_ARRAY_INDEX", 0},
        Source{"PARALLEL_SEQ", 1}, Source{"OMPI_COMM_WORLD_RANK", 0}}) {
    if (const auto value = whole(std::getenv(variable)); value && *value >= first)
      return EnvironmentIndex{variable, *value - first};
  }
  return fail(ErrorCode::not_found, "the environment contains no task index");
}

}  // namespace todbench
