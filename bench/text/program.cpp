#include "bench/text/program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>

extern char** environ;

namespace todbench {
namespace {

constexpr std::size_t most_output_bytes = 65536;

/// What a child writes, until it closes its end. More than is kept is read and dropped, so that it does not wait.
std::string everything_from(int descriptor) {
  std::string text;
  char buffer[4096];
  for (;;) {
    const ssize_t got = ::read(descriptor, buffer, sizeof buffer);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    text.append(buffer, std::min(static_cast<std::size_t>(got), most_output_bytes - text.size()));
  }
  return text;
}

Result<int> ended_with(pid_t process) {
  int status = 0;
  while (::waitpid(process, &status, 0) < 0) {
    if (errno != EINTR) return fail(ErrorCode::internal, std::string("waiting for a program: ") + std::strerror(errno));
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

Result<ProgramRun> run_program(std::vector<std::string> words, ProgramOutput output) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  int ends[2] = {-1, -1};
  if (::pipe2(ends, O_CLOEXEC) != 0)
    return fail(ErrorCode::internal, words.front() + ": no pipe: " + std::strerror(errno));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (output == ProgramOutput::kept) {
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  }
  pid_t process = -1;
  const int problem = ::posix_spawnp(&process, pointers.front(), &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  if (problem != 0) {
    ::close(ends[0]);
    return fail(problem == ENOENT ? ErrorCode::not_found : ErrorCode::internal,
                words.front() + ": " + (problem == ENOENT ? "is not installed" : std::strerror(problem)));
  }
  ProgramRun run;
  run.output = everything_from(ends[0]);
  ::close(ends[0]);
  const auto code = ended_with(process);
  if (!code) return tl::unexpected(code.error());
  run.exit_code = *code;
  return run;
}

}  // namespace todbench
