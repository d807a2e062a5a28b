// SPDX-License-Identifier: GPL-3.0-or-later
// `todbench sweep tasks` and `submit`: the task list for the scheduler of a laboratory.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "bench/cli/console.h"

namespace todbench {

/// Arguments of the parts of `todbench sweep`.
struct SweepArguments {
  std::string file, scheduler = "parallel", engine = "local", options_file, csv, sqlite, page, response;
  std::optional<std::size_t> index, jobs;
  std::string range;
  std::size_t chunk = 0;  ///< 0: not given
  std::string program = "todbench";
  bool list = false, predict = false, partial = false, dry_run = false;
};

/// Prints the list or script without submitting it; returns the exit code.
[[nodiscard]] int print_tasks(Console& console, const SweepArguments& a);
/// Writes the script next to the results and, unless it is a dry run, calls sbatch; returns the exit code.
[[nodiscard]] int submit_to_slurm(Console& console, SweepArguments a);

}  // namespace todbench
