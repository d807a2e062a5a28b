// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/sweep/processes.h"

#include <signal.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "acquisition/base/process.h"
#include "acquisition/base/try.h"

namespace todbench {
namespace {

constexpr int interrupted_code = 130;

/// The running children. All members are thread-safe.
class Children {
 public:
  /// Starts a child unless a stop was requested, waits for its end without polling, and returns its exit code; empty if
  /// it was not started.
  Result<std::optional<int>> run(std::vector<std::string> command) {
    pid_t process = 0;
    {
      const std::lock_guard lock(mutex_);
      if (ending_) return std::optional<int>();
      const Descriptor discarded = null_device();
      TODBENCH_TRY(const auto started, start_program(std::move(command), {.output = discarded.get()}));
      process = started;
      processes_.push_back(process);
    }
    // The process id stays reserved until it is off the list, so that no other process gets the signal.
    siginfo_t end{};
    while (::waitid(P_PID, static_cast<id_t>(process), &end, WEXITED | WNOWAIT) < 0 && errno == EINTR) {
    }
    const std::lock_guard lock(mutex_);
    std::erase(processes_, process);
    TODBENCH_TRY(const auto code, wait_for_program(process));
    return std::optional<int>(code);
  }
  /// Asks the running children to end; no other is started.
  void ask_to_end() {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    for (const pid_t process : processes_) ::kill(process, SIGTERM);
  }

 private:
  std::mutex mutex_;
  bool ending_ = false;
  std::vector<pid_t> processes_;
};

/// State shared by the threads of a pool, except the children.
struct PoolState {
  std::mutex mutex{};
  std::size_t next = 0, done = 0;
  int worst = 0;
  std::optional<Error> error{};
};

/// Runs one job: chunk after chunk while there are any.
void run_job(const ProcessPool& pool, Children& children, PoolState& state) {
  while (true) {
    std::size_t first = 0, last = 0;
    {
      const std::lock_guard lock(state.mutex);
      if (state.next >= pool.tasks) return;
      first = state.next;
      last = std::min(first + pool.chunk, pool.tasks) - 1;
      state.next = last + 1;
    }
    const auto code = children.run(pool.command(first, last));
    const std::lock_guard lock(state.mutex);
    if (!code && !state.error) state.error = code.error();
    if (!code) children.ask_to_end();
    if (!code || !*code) return;
    state.worst = std::max(state.worst, **code);
    state.done += last - first + 1;
    if (pool.on_progress) pool.on_progress(state.done);
  }
}

}  // namespace

Result<int> run_pool(const ProcessPool& pool, std::stop_token stop) {
  Children children;
  PoolState state;
  {
    const std::stop_callback on_stop(stop, [&] { children.ask_to_end(); });
    std::vector<std::jthread> jobs;
    for (std::size_t i = 0; i < std::min(pool.jobs, (pool.tasks + pool.chunk - 1) / pool.chunk); ++i)
      jobs.emplace_back([&] { run_job(pool, children, state); });
  }
  if (state.error) return tl::unexpected(*state.error);
  return stop.stop_requested() ? interrupted_code : state.worst;
}

}  // namespace todbench
