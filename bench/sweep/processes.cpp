#include "bench/sweep/processes.h"

#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

extern char** environ;

namespace todbench {
namespace {

constexpr int interrupted_code = 130;

int code_of(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// The children that run. All members are thread-safe.
class Children {
 public:
  /// Starts a child unless it is too late for that, waits for its end without asking again and again, and says its exit
  /// code; nothing where it was too late.
  Result<std::optional<int>> run(std::vector<std::string> command) {
    pid_t process = 0;
    {
      const std::lock_guard lock(mutex_);
      if (ending_) return std::optional<int>();
      const auto started = spawned(std::move(command), ChildOutput::nowhere);
      if (!started) return tl::unexpected(started.error());
      process = *started;
      processes_.push_back(process);
    }
    // Its number stays its own until it is taken off the list: nobody else is sent the signal.
    siginfo_t end{};
    while (::waitid(P_PID, static_cast<id_t>(process), &end, WEXITED | WNOWAIT) < 0 && errno == EINTR) {
    }
    const std::lock_guard lock(mutex_);
    std::erase(processes_, process);
    const auto code = ended(process);
    if (!code) return tl::unexpected(code.error());
    return std::optional<int>(*code);
  }
  /// Asks those that run to end; no other is started.
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

/// What the threads of a pool share, but for the children.
struct PoolState {
  std::mutex mutex{};
  std::size_t next = 0, done = 0;
  int worst = 0;
  std::optional<Error> error{};
};

/// One of the jobs: chunk after chunk, as long as there are any.
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

Result<pid_t> spawned(std::vector<std::string> words, ChildOutput output) {
  std::vector<char*> pointers;
  for (auto& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (output == ChildOutput::nowhere) posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", 1, 0);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  pid_t process = 0;
  const int failure = ::posix_spawnp(&process, words.front().c_str(), &actions, &attributes, pointers.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (failure == 0) return process;
  return fail(ErrorCode::not_found, words.front() + " cannot be started: " + std::strerror(failure));
}

Result<int> ended(pid_t process) {
  int status = 0;
  while (::waitpid(process, &status, 0) < 0) {
    if (errno != EINTR) return fail(ErrorCode::internal, "a process cannot be waited for");
  }
  return code_of(status);
}

std::string own_program() {
  std::error_code problem;
  return std::filesystem::read_symlink("/proc/self/exe", problem).string();
}

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
