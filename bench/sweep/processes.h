// SPDX-License-Identifier: GPL-3.0-or-later
// Execution of tasks in parallel processes, so that a crashed or killed task does not affect other tasks.
#pragma once

#include <cstddef>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// Tasks and their processes.
struct ProcessPool {
  std::size_t tasks = 0, jobs = 1;
  std::size_t chunk = 1;  ///< tasks per process
  /// Returns the command for tasks `first` to `last`, both included.
  std::function<std::vector<std::string>(std::size_t first, std::size_t last)> command{};  ///< any thread
  std::function<void(std::size_t done)> on_progress{};  ///< any thread, one call at a time
};
/// Runs all tasks in `jobs` parallel processes, with one waiting thread for each. Returns the worst exit code. On a
/// stop request the function ends its children with SIGTERM, waits for them and returns 130.
[[nodiscard]] Result<int> run_pool(const ProcessPool& pool, std::stop_token stop);

}  // namespace todbench
