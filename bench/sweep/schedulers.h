// SPDX-License-Identifier: GPL-3.0-or-later
// Task list of a sweep as text for job schedulers. These functions do not submit the list.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// Program that runs the tasks.
enum class Scheduler { parallel, slurm, gridengine, snakemake, make };
inline constexpr std::array all_schedulers{Scheduler::parallel, Scheduler::slurm, Scheduler::gridengine,
                                           Scheduler::snakemake, Scheduler::make};
/// Returns the name of the enumerator.
[[nodiscard]] std::string_view to_string(Scheduler scheduler);

/// Tasks as jobs.
struct JobList {
  std::string program = "todbench";  ///< command of the program on the computers of the tasks
  std::string sweep_file;            ///< path of the file on the computers of the tasks
  std::size_t tasks = 0;
  std::size_t chunk = 1;  ///< tasks per job
  /// Returns the number of jobs.
  [[nodiscard]] std::size_t jobs() const { return (tasks + chunk - 1) / chunk; }
};

/// Returns the job text. GNU parallel: one command per line, always all commands in the same order, because `--resume`
/// compares line numbers. Slurm and Grid Engine: a script of an array job. Snakemake and make: a file of rules.
/// `site_options`: options of the site, placed in front with the scheduler's prefix ("#SBATCH --partition=short").
[[nodiscard]] std::string job_text(Scheduler scheduler, const JobList& jobs,
                                   const std::vector<std::string>& site_options);

/// Reads a file of site options: one option per line, "--partition=short"; empty lines and comments (#) are skipped.
/// Errors: `invalid_input` for a line that is not an option.
[[nodiscard]] Result<std::vector<std::string>> site_options_from(std::string_view text, std::string_view file);

/// Returns a word for a shell, in single quotes if necessary.
[[nodiscard]] std::string shell_word(std::string_view text);

/// Index of a job from the environment of a scheduler: SLURM_ARRAY_TASK_ID, SGE_TASK_ID (from 1; "undefined" outside
/// arrays), PBS_ARRAY_INDEX, PARALLEL_SEQ (from 1), OMPI_COMM_WORLD_RANK, in this order. `index` starts at 0.
struct EnvironmentIndex {
  std::string variable;
  std::size_t index = 0;
};
/// Returns the index of this job.
[[nodiscard]] Result<EnvironmentIndex> index_from_environment();

}  // namespace todbench
