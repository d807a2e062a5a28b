// Tasks in processes side by side: what crashes or is killed takes no other task with it.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

/// Where a child's standard output goes.
enum class ChildOutput { ours, nowhere };
/// Starts a program by name or path with no signal blocked. `not_found` with the name.
[[nodiscard]] Result<pid_t> spawned(std::vector<std::string> words, ChildOutput output);
/// Its exit code, or 128 + the signal that ended it. `internal` where it is no child.
[[nodiscard]] Result<int> ended(pid_t process);
/// This program's file.
[[nodiscard]] std::string own_program();

struct ProcessPool {
  std::size_t tasks = 0, jobs = 1;
  std::size_t chunk = 1;  ///< tasks a process
  /// The command for tasks `first` to `last`, both included.
  std::function<std::vector<std::string>(std::size_t first, std::size_t last)> command{};  ///< any thread
  std::function<void(std::size_t done)> on_progress{};  ///< any thread, one call at a time
};
/// Runs all tasks, `jobs` processes at a time, each awaited by a thread that sleeps until then; the worst exit code.
/// When asked to stop it ends its children with SIGTERM, waits for them and returns 130.
[[nodiscard]] Result<int> run_pool(const ProcessPool& pool, std::stop_token stop);

}  // namespace todbench
