#include "bench/sweep/processes.h"

#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <thread>
#include <utility>

extern char** environ;

namespace todbench {
namespace {

constexpr int interrupted_code = 130;

int code_of(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// The children that run; whatever happens none is left behind.
class Children {
 public:
  ~Children() {
    for (const pid_t process : processes_) {
      ::kill(process, SIGTERM);
      (void)ended(process).has_value();
    }
  }
  void add(pid_t process) { processes_.push_back(process); }
  [[nodiscard]] std::size_t count() const { return processes_.size(); }
  void ask_to_end() const {
    for (const pid_t process : processes_) ::kill(process, SIGTERM);
  }
  /// The exit codes of those that have ended, taken from the list.
  std::vector<int> taken() {
    std::vector<int> codes;
    std::erase_if(processes_, [&](pid_t process) {
      int status = 0;
      const pid_t found = ::waitpid(process, &status, WNOHANG);
      if (found == 0 || (found < 0 && errno == EINTR)) return false;
      codes.push_back(found < 0 ? 1 : code_of(status));
      return true;
    });
    return codes;
  }

 private:
  std::vector<pid_t> processes_;
};

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
  std::size_t next = 0, done = 0;
  int worst = 0;
  bool asked_to_end = false;
  while (children.count() > 0 || (next < pool.tasks && !stop.stop_requested())) {
    while (next < pool.tasks && children.count() < pool.jobs && !stop.stop_requested()) {
      const std::size_t last = std::min(next + pool.chunk, pool.tasks) - 1;
      const auto process = spawned(pool.command(next, last), ChildOutput::nowhere);
      if (!process) return tl::unexpected(process.error());
      children.add(*process);
      next = last + 1;
    }
    if (stop.stop_requested() && !std::exchange(asked_to_end, true)) children.ask_to_end();
    for (const int code : children.taken()) {
      worst = std::max(worst, code);
      done = std::min(done + pool.chunk, pool.tasks);
      if (pool.on_progress) pool.on_progress(done);
    }
    // A process takes tenths of a second at least; nobody waits for these milliseconds.
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return stop.stop_requested() ? interrupted_code : worst;
}

}  // namespace todbench
