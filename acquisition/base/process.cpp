// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/base/process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>

#include "acquisition/base/try.h"

extern char** environ;

namespace todbench {
namespace {

constexpr std::size_t most_output_bytes = 1 << 20;
/// So that a stop is noticed even if the system gave no stop event.
constexpr int longest_poll_ms = 500;

/// Readable when the child has ended; none on kernels before Linux 5.3.
Descriptor end_of(pid_t process) {
  return Descriptor(static_cast<int>(::syscall(SYS_pidfd_open, process, 0U)));
}

/// Reads once. Data beyond the limit are discarded, so that the child does not block. False at the end.
bool read_some(int descriptor, std::string& text) {
  std::array<char, 4096> buffer{};
  const ssize_t got = ::read(descriptor, buffer.data(), buffer.size());
  if (got < 0) return errno == EINTR;
  text.append(buffer.data(), std::min(static_cast<std::size_t>(got), most_output_bytes - text.size()));
  return got > 0;
}

/// Collects the output of a child until it has closed its end and ended, or until a stop request was passed on to it.
std::string output_of(pid_t process, Descriptor output, const std::stop_token& stop) {
  const Descriptor end = end_of(process);
  std::optional<StopEvent> stopped(stop);
  std::string text;
  while (output.is_open() || (stopped && end.is_open())) {
    std::array<pollfd, 3> polled{pollfd{output.get(), POLLIN, 0}, pollfd{output.is_open() ? -1 : end.get(), POLLIN, 0},
                                 pollfd{stopped ? stopped->fd() : -1, POLLIN, 0}};
    if (::poll(polled.data(), polled.size(), longest_poll_ms) < 0 && errno != EINTR) break;
    if (stopped && stop.stop_requested()) {
      ::kill(process, SIGTERM);
      stopped.reset();
    }
    if (polled[0].revents != 0 && !read_some(output.get(), text)) output.close();
    if (polled[1].revents != 0) break;
  }
  return text;
}

}  // namespace

Result<Pipe> make_pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0)
    return fail(ErrorCode::internal, std::string("cannot create a pipe: ") + std::strerror(errno));
  return Pipe{Descriptor(ends[0]), Descriptor(ends[1])};
}

Descriptor null_device() {
  return Descriptor(::open("/dev/null", O_RDWR | O_CLOEXEC));
}

Result<pid_t> start_program(std::vector<std::string> words, const ChildStreams& streams, ChildGroup group) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  const std::array given{streams.input, streams.output, streams.error, streams.at_three};
  for (int number = 0; number < 4; ++number) {
    const int descriptor = given.at(static_cast<std::size_t>(number));
    if (descriptor >= 0) posix_spawn_file_actions_adddup2(&actions, descriptor, number);
  }
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none, pipe_signal;
  sigemptyset(&none);
  sigemptyset(&pipe_signal);
  sigaddset(&pipe_signal, SIGPIPE);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &pipe_signal);
  posix_spawnattr_setpgroup(&attributes, 0);
  const int flags =
      POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | (group == ChildGroup::own ? POSIX_SPAWN_SETPGROUP : 0);
  posix_spawnattr_setflags(&attributes, static_cast<short>(flags));
  pid_t process = -1;
  const int problem = ::posix_spawnp(&process, pointers.front(), &actions, &attributes, pointers.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (problem == 0) return process;
  if (problem == ENOENT) return fail(ErrorCode::not_found, words.front() + " is not installed");
  return fail(ErrorCode::internal, words.front() + " cannot be started: " + std::strerror(problem));
}

Result<int> wait_for_program(pid_t process) {
  int status = 0;
  while (::waitpid(process, &status, 0) < 0) {
    if (errno != EINTR)
      return fail(ErrorCode::internal, std::string("cannot wait for a program: ") + std::strerror(errno));
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

Result<ProgramRun> run_program(std::vector<std::string> words, ProgramOutput output, const std::stop_token& stop) {
  Pipe pipe;
  Descriptor discarded;
  ChildStreams streams;
  if (output != ProgramOutput::shown) {
    TODBENCH_TRY(pipe, make_pipe());
    if (output == ProgramOutput::kept_but_errors) discarded = null_device();
    streams.output = pipe.write.get();
    streams.error = output == ProgramOutput::kept ? pipe.write.get() : discarded.get();
  }
  const auto process = start_program(std::move(words), streams);
  pipe.write.close();
  if (!process) return tl::unexpected(process.error());
  ProgramRun run;
  run.output = output_of(*process, std::move(pipe.read), stop);
  TODBENCH_TRY(run.exit_code, wait_for_program(*process));
  return run;
}

std::string own_program() {
  std::error_code problem;
  return std::filesystem::read_symlink("/proc/self/exe", problem).string();
}

}  // namespace todbench
