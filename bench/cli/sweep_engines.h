// `todbench sweep tasks` and `submit`: the task list for what a laboratory schedules with.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "bench/cli/console.h"

namespace todbench {

/// What the parts of `todbench sweep` take.
struct SweepArguments {
  std::string file, scheduler = "parallel", engine = "local", options_file, csv, sqlite, page,
                    response = "acuity_per_mrad";
  std::optional<std::size_t> index, jobs;
  std::string range;
  std::size_t chunk = 0;  ///< 0: not said
  std::string program = "todbench";
  bool list = false, predict = false, partial = false, dry_run = false;
};

/// Prints the list or script; submits nothing. The exit code.
[[nodiscard]] int print_tasks(Console& console, const SweepArguments& a);
/// Writes the script beside the results and calls sbatch, unless it is a dry run. The exit code.
[[nodiscard]] int submit_to_slurm(Console& console, SweepArguments a);

}  // namespace todbench
