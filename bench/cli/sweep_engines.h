// SPDX-License-Identifier: GPL-3.0-or-later
// Commands `todbench sweep tasks` and `submit`: the task list for the scheduler of a laboratory.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "bench/cli/console.h"

namespace todbench {

/// Arguments of the subcommands of `todbench sweep`.
struct SweepArguments {
  std::string file,            ///< sweep file
      scheduler = "parallel",  ///< scheduler of `tasks`: parallel, slurm, gridengine, snakemake or make
      engine = "local",        ///< engine of `submit`: local or slurm
      options_file,            ///< file with scheduler options of the site; empty: none
      csv,                     ///< CSV file of `collect`; empty: default file next to the results
      sqlite,                  ///< SQLite file of `collect`; empty: default file next to the results
      page,                    ///< page of `collect`; empty: no page
      response;                ///< column whose dependence on the parameters is computed; empty: default of the kind
  std::optional<std::size_t> index,  ///< index of the task to run, or of the chunk with --chunk; empty: not stated
      jobs;                          ///< number of parallel processes; empty: not stated
  /// Tasks to run as FIRST-LAST, both included; empty: not stated.
  std::string range;
  /// Number of tasks per index; 0: not stated.
  std::size_t chunk = 0;
  /// Command that starts todbench on the computers of the scheduler.
  std::string program = "todbench";
  bool list = false,    ///< lists every task
      predict = false,  ///< predicts the time per task
      partial = false,  ///< skips tasks without a result, which are otherwise an error
      dry_run = false;  ///< writes the script without submitting it
};

/// Prints the task list or script without submitting it; returns the exit code.
[[nodiscard]] int print_tasks(Console& console, const SweepArguments& a);
/// Writes the script next to the results and, unless it is a dry run, calls sbatch; returns the exit code.
[[nodiscard]] int submit_to_slurm(Console& console, SweepArguments a);

}  // namespace todbench
