// SPDX-License-Identifier: GPL-3.0-or-later
// The task list of a sweep for job schedulers, as text; does not submit it.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

enum class Scheduler { parallel, slurm, gridengine, snakemake, make };
inline constexpr std::array all_schedulers{Scheduler::parallel, Scheduler::slurm, Scheduler::gridengine,
                                           Scheduler::snakemake, Scheduler::make};
[[nodiscard]] std::string_view to_string(Scheduler scheduler);

struct JobList {
  std::string program = "todbench";  ///< its command where the tasks run
  std::string sweep_file;            ///< its path where the tasks run
  std::size_t tasks = 0;
  std::size_t chunk = 1;  ///< tasks per job
  [[nodiscard]] std::size_t jobs() const { return (tasks + chunk - 1) / chunk; }
};

/// Returns the job text. GNU parallel: one command per line, always all of them in the same order, because `--resume`
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
/// arrays), PBS_ARRAY_INDEX, PARALLEL_SEQ (from 1), OMPI_COMM_WORLD_RANK, in this order. Starts at 0 here.
struct EnvironmentIndex {
  std::string variable;
  std::size_t index = 0;
};
[[nodiscard]] Result<EnvironmentIndex> index_from_environment();

}  // namespace todbench
