// SPDX-License-Identifier: GPL-3.0-or-later
// Results of tasks on disk: one file each, complete or absent. Tasks share no files.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/sweep/task_plan.h"

namespace todbench {

/// Returns the path of a task's result: a folder for each thousand, "RESULTS/000/i000123-HASH.json".
[[nodiscard]] std::filesystem::path result_file(const Sweep& sweep, const SweepTask& task);

/// State of a task. The names of files and the content of locks determine the state.
enum class TaskState {
  missing,
  done,     ///< its result exists
  failed,   ///< "NAME.failed" contains the reason; a new run tries again
  running,  ///< "NAME.lock" of a live process, or of a different host within the last hours
  stale,    ///< a lock whose process has ended
  foreign,  ///< a result of the same index with a different hash, from a different sweep file
};
/// States of all tasks.
struct SweepStatus {
  std::vector<TaskState> states;  ///< by index
  /// Returns the number of tasks in a state.
  [[nodiscard]] std::size_t count(TaskState state) const;
  /// Returns the indices that are not done, as "3,17-20".
  [[nodiscard]] std::string open_list() const;
};
/// Returns the states. Reads folders and locks, and no other files.
[[nodiscard]] SweepStatus sweep_status(const Sweep& sweep);
/// Returns the reason why a task failed.
[[nodiscard]] std::string failure_of(const Sweep& sweep, std::size_t index);

/// Outcome of one task.
struct TaskOutcome {
  enum class Kind { done, already_done, failed, locked } kind = Kind::done;
  std::optional<Error> error{};
};
/// Runs a task unless its result exists. A result is written to a temporary file and renamed, so repeated calls are
/// safe. A failure is stored as a file. Errors: `invalid_input` (same index, different hash); `interrupted` (no file is
/// written).
[[nodiscard]] TaskOutcome run_and_store(const RunnableSweep& runnable, std::size_t index, std::stop_token stop);

}  // namespace todbench
