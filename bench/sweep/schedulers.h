// The task list of a sweep for what laboratories schedule with: text only; nothing is submitted here.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

enum class Scheduler { parallel, slurm, gridengine, snakemake, make };
inline constexpr std::array all_schedulers{Scheduler::parallel, Scheduler::slurm, Scheduler::gridengine,
                                           Scheduler::snakemake, Scheduler::make};
[[nodiscard]] std::string_view to_string(Scheduler scheduler);

struct JobList {
  std::string program = "todbench";  ///< as it is called where the tasks run
  std::string sweep_file;            ///< as it is called there
  std::size_t tasks = 0;
  std::size_t chunk = 1;  ///< tasks a job
  [[nodiscard]] std::size_t jobs() const { return (tasks + chunk - 1) / chunk; }
};

/// GNU parallel: a command a line, always all of them and in one order, as `--resume` compares line numbers; Slurm and
/// Grid Engine: a script of an array job; Snakemake and make: a file of rules. `site_options`: lines of the site, put
/// in front with the scheduler's own mark ("#SBATCH --partition=short").
[[nodiscard]] std::string job_text(Scheduler scheduler, const JobList& jobs,
                                   const std::vector<std::string>& site_options);

/// Lines of a file of site options: one option a line, "--partition=short"; empty lines and remarks (#) are skipped.
/// `invalid_input` for a line that is no option.
[[nodiscard]] Result<std::vector<std::string>> site_options_from(std::string_view text, std::string_view file);

/// A word for a shell, in single quotes where it needs them.
[[nodiscard]] std::string shell_word(std::string_view text);

/// The index of a job from the environment of a scheduler: SLURM_ARRAY_TASK_ID, SGE_TASK_ID (from 1; "undefined"
/// outside arrays), PBS_ARRAY_INDEX, PARALLEL_SEQ (from 1), OMPI_COMM_WORLD_RANK, in this order; from 0 here.
struct EnvironmentIndex {
  std::string variable;
  std::size_t index = 0;
};
[[nodiscard]] Result<EnvironmentIndex> index_from_environment();

}  // namespace todbench
