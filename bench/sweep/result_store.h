// Results of tasks on disk: one file each, whole or not there; nothing is shared between tasks.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/sweep/task_plan.h"

namespace todbench {

/// Where the file of a task is: a folder for each thousand, "RESULTS/000/i000123-HASH.json".
[[nodiscard]] std::filesystem::path result_file(const Sweep& sweep, const SweepTask& task);

/// How a task stands, from the names of files alone.
enum class TaskState {
  missing,
  done,     ///< its result is there
  failed,   ///< "NAME.failed" says why; a new run tries again
  running,  ///< "NAME.lock" of a process that is alive, or of another host within the last hours
  stale,    ///< a lock that nobody holds any more
  foreign,  ///< a result of the same index with another hash: of another sweep file
};
struct SweepStatus {
  std::vector<TaskState> states;  ///< by index
  [[nodiscard]] std::size_t count(TaskState state) const;
  /// "3,17-20": indices that are not done.
  [[nodiscard]] std::string open_list() const;
};
/// Reads folders, no files but locks.
[[nodiscard]] SweepStatus sweep_status(const Sweep& sweep);
/// Why a task failed.
[[nodiscard]] std::string failure_of(const Sweep& sweep, std::size_t index);

/// What came of one task.
struct TaskOutcome {
  enum class Kind { done, already_done, failed, locked } kind = Kind::done;
  std::optional<Error> error{};
};
/// Runs a task unless its result is there: idempotent, and atomic (written beside and renamed). A failure is kept as a
/// file. A result of the same index with another hash is refused with `invalid_input`. `interrupted` leaves nothing.
[[nodiscard]] TaskOutcome run_and_store(const RunnableSweep& runnable, std::size_t index, std::stop_token stop);

}  // namespace todbench
