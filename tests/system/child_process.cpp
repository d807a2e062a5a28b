// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/system/child_process.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <iterator>

#include "tests/support/patience.h"

namespace todbench::testing {
namespace {

using Clock = std::chrono::steady_clock;
using testing_support::patience;

/// Far longer than anything a test waits for takes on an idle machine.
constexpr std::chrono::seconds idle_patience{120};
/// How often a condition that is no output is looked at again.
constexpr std::chrono::milliseconds look_again{5};

/// Between fork and exec: only what may be called there.
void prepare_child(const ChildOptions& options) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  ::signal(SIGINT, SIG_DFL);  // ignored in programs that a shell started in the background
  if (!options.folder.empty() && ::chdir(options.folder.c_str()) != 0) ::_exit(126);
  for (const auto& [name, value] : options.setenv) ::setenv(name.c_str(), value.c_str(), 1);
  if (options.largest_file_bytes) {
    const rlimit limit{*options.largest_file_bytes, *options.largest_file_bytes};
    if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) ::_exit(126);
  }
  if (options.one_processor) {
    cpu_set_t mine, one;
    if (::sched_getaffinity(0, sizeof mine, &mine) != 0) ::_exit(126);
    CPU_ZERO(&one);
    for (unsigned i = 0; i < CPU_SETSIZE && CPU_COUNT(&one) == 0; ++i) {
      if (CPU_ISSET(i, &mine)) CPU_SET(i, &one);
    }
    if (::sched_setaffinity(0, sizeof one, &one) != 0) ::_exit(126);
  }
  if (!options.standard_output.empty()) {
    const int file = ::open(options.standard_output.c_str(), O_WRONLY);
    if (file < 0 || ::dup2(file, STDOUT_FILENO) < 0) ::_exit(126);
  }
}

void close_end(int& end) {
  if (end >= 0) ::close(end);
  end = -1;
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& command, const ChildOptions& options) {
  std::array<int, 2> out{}, err{};
  if (::pipe2(out.data(), O_CLOEXEC) != 0 || ::pipe2(err.data(), O_CLOEXEC) != 0) std::abort();
  std::vector<char*> words;
  for (const auto& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  pid_ = ::fork();
  if (pid_ == 0) {
    const int nothing = ::open("/dev/null", O_RDONLY);
    ::dup2(nothing, STDIN_FILENO);
    ::dup2(out[1], STDOUT_FILENO);
    ::dup2(err[1], STDERR_FILENO);
    prepare_child(options);
    ::execv(words.front(), words.data());
    ::_exit(127);
  }
  ::close(out[1]);
  ::close(err[1]);
  out_end_ = out[0];
  err_end_ = err[0];
}

ChildProcess::~ChildProcess() {
  if (pid_ > 0) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  close_end(out_end_);
  close_end(err_end_);
}

int ChildProcess::threads() const {
  std::error_code ended;
  const std::filesystem::directory_iterator tasks("/proc/" + std::to_string(pid_) + "/task", ended);
  return ended ? 0 : static_cast<int>(std::distance(begin(tasks), end(tasks)));
}

void ChildProcess::signal(int number) const {
  if (pid_ > 0) ::kill(pid_, number);
}

bool ChildProcess::read_some(std::chrono::milliseconds at_most) {
  std::array<pollfd, 2> ends{pollfd{out_end_, POLLIN, 0}, pollfd{err_end_, POLLIN, 0}};
  if (out_end_ < 0 && err_end_ < 0) return false;
  if (::poll(ends.data(), ends.size(), static_cast<int>(at_most.count())) < 0 && errno != EINTR) return false;
  const auto take = [](const pollfd& end, int& descriptor, std::string& text) {
    if ((end.revents & (POLLIN | POLLHUP)) == 0) return;
    std::array<char, 65536> piece{};
    const ssize_t count = ::read(descriptor, piece.data(), piece.size());
    if (count > 0) text.append(piece.data(), static_cast<std::size_t>(count));
    if (count == 0) close_end(descriptor);
  };
  take(ends[0], out_end_, out_);
  take(ends[1], err_end_, err_);
  return out_end_ >= 0 || err_end_ >= 0;
}

bool ChildProcess::wait_until(const std::function<bool()>& enough) {
  const auto begin = Clock::now();
  while (!enough()) {
    if (Clock::now() - begin > patience(idle_patience) || !read_some(look_again)) return enough();
  }
  return true;
}

Ended ChildProcess::wait() {
  const auto begin = Clock::now();
  while (read_some(std::chrono::milliseconds(100))) {
    if (Clock::now() - begin < patience(idle_patience)) continue;
    ADD_FAILURE() << "the program does not end; it said so far:\n" << out_ << err_;
    ::kill(pid_, SIGKILL);
  }
  int status = 0;
  ::waitpid(pid_, &status, 0);
  pid_ = -1;
  return {.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), .out = out_, .err = err_};
}

std::vector<std::string> todbench_command(const std::vector<std::string>& arguments) {
  std::vector<std::string> command{TODBENCH_PROGRAM};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return command;
}

Ended todbench(const std::vector<std::string>& arguments, const ChildOptions& options) {
  return ChildProcess(todbench_command(arguments), options).wait();
}

}  // namespace todbench::testing
