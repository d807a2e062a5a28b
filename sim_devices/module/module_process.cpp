#include "sim_devices/module/module_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <utility>

#include <fmt/format.h>

#include "acquisition/core/safe_text.h"
#include "sim_devices/module/npy_message.h"

extern char** environ;

namespace todbench {
namespace {

constexpr std::size_t kept_errors = 4096;

struct Pipe {
  int read = -1, write = -1;
};

Result<Pipe> made_pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return fail(ErrorCode::internal, "no pipe to a module can be made");
  return Pipe{ends[0], ends[1]};
}

void close_end(int& descriptor) {
  if (descriptor >= 0) ::close(descriptor);
  descriptor = -1;
}

void never_wait(int descriptor) {
  ::fcntl(descriptor, F_SETFL, ::fcntl(descriptor, F_GETFL) | O_NONBLOCK);
}

/// A shell for the command, in a network of its own: the file system is as ours, its processes end with the first.
std::vector<std::string> words_of(const ModuleOptions& options) {
  std::vector<std::string> words;
  if (options.network == ModuleNetwork::cut && can_cut_network()) {
    // Not --die-with-parent: it would die with the thread that started it. A bench that is gone has closed the input.
    words = {"bwrap", "--dev-bind", "/", "/", "--unshare-net", "--unshare-pid", "--proc", "/proc"};
  }
  const std::string limit =
      options.memory_limit_mib == 0 ? "" : fmt::format("ulimit -v {} || exit 1\n", options.memory_limit_mib * 1024);
  words.insert(words.end(), {"/bin/sh", "-c", limit + options.command});
  return words;
}

/// The words in a process group of their own, with these standard streams and no signal blocked.
Result<pid_t> spawned_group(std::vector<std::string> words, const Pipe& in, const Pipe& out, const Pipe& err) {
  std::vector<char*> pointers;
  for (auto& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in.read, 0);
  posix_spawn_file_actions_adddup2(&actions, out.write, 1);
  posix_spawn_file_actions_adddup2(&actions, err.write, 2);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none, pipe_signal;
  sigemptyset(&none);
  sigemptyset(&pipe_signal);
  sigaddset(&pipe_signal, SIGPIPE);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &pipe_signal);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  pid_t process = -1;
  const int failure = ::posix_spawnp(&process, pointers.front(), &actions, &attributes, pointers.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) return fail(ErrorCode::internal, "no process for a module can be made");
  return process;
}

}  // namespace

bool can_cut_network() {
  static const bool can = std::system(
                              "bwrap --dev-bind / / --unshare-net --unshare-pid --proc /proc true "
                              ">/dev/null 2>&1 </dev/null") == 0;
  return can;
}

Result<ModuleProcess> ModuleProcess::start(const ModuleOptions& options) {
  auto in = made_pipe(), out = made_pipe(), err = made_pipe();
  for (const auto* pipe : {&in, &out, &err}) {
    if (!*pipe) return tl::unexpected(pipe->error());
  }
  auto process = spawned_group(words_of(options), *in, *out, *err);
  close_end(in->read);
  close_end(out->write);
  close_end(err->write);
  ModuleProcess module(options);
  module.in_ = in->write;
  module.out_ = out->read;
  module.err_ = err->read;
  if (!process) return tl::unexpected(process.error());
  module.process_ = *process;
  for (const int end : {module.in_, module.out_, module.err_}) never_wait(end);
  // A whole picture at once where the system allows it: fewer changes between the two processes.
  constexpr int picture_bytes = 1 << 20;
  for (const int end : {module.in_, module.out_}) ::fcntl(end, F_SETPIPE_SZ, picture_bytes);
  module.to_write_ = to_message(std::string_view(options.header));
  return module;
}

ModuleProcess::ModuleProcess(ModuleProcess&& other) noexcept
    : options_(std::move(other.options_)),
      process_(std::exchange(other.process_, -1)),
      exit_code_(other.exit_code_),
      in_(std::exchange(other.in_, -1)),
      out_(std::exchange(other.out_, -1)),
      err_(std::exchange(other.err_, -1)),
      to_write_(std::move(other.to_write_)),
      read_(std::move(other.read_)),
      errors_(std::move(other.errors_)),
      error_line_(std::move(other.error_line_)),
      buffer_(std::move(other.buffer_)) {}

ModuleProcess::~ModuleProcess() {
  end();
}

void ModuleProcess::end() {
  close_end(in_);
  close_end(out_);
  close_end(err_);
  if (process_ < 0) return;
  // Everything that it started belongs to its group.
  ::kill(-process_, SIGKILL);
  int status = 0;
  pid_t ended = -1;
  while ((ended = ::waitpid(process_, &status, 0)) < 0 && errno == EINTR) {
  }
  if (ended == process_ && WIFEXITED(status)) exit_code_ = WEXITSTATUS(status);
  process_ = -1;
}

void ModuleProcess::say_lines(std::string_view words) {
  if (!options_.on_error_line) return;
  for (const char c : words) {
    // A line without an end is no reason to keep all of it.
    if (c != '\n' && error_line_.size() < kept_errors) {
      error_line_ += c;
      continue;
    }
    if (!error_line_.empty()) options_.on_error_line(error_line_);
    error_line_.clear();
  }
}

void ModuleProcess::take_errors() {
  std::array<char, 4096> buffer{};
  for (ssize_t got = 0; (got = ::read(err_, buffer.data(), buffer.size())) > 0;) {
    const std::string_view words(buffer.data(), static_cast<std::size_t>(got));
    errors_ += words;
    say_lines(words);
    if (errors_.size() > kept_errors) errors_.erase(0, errors_.size() - kept_errors);
    if (static_cast<std::size_t>(got) < buffer.size()) break;
  }
}

Error ModuleProcess::with_last_words(Error error) const {
  std::string_view text = errors_;
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r' || text.back() == ' ')) text.remove_suffix(1);
  const auto line = text.substr(text.rfind('\n') == std::string_view::npos ? 0 : text.rfind('\n') + 1);
  if (!line.empty()) error.message += "; it said: " + one_line(std::string(line));
  return error;
}

Error ModuleProcess::died() const {
  return with_last_words({ErrorCode::disconnected, "the module ended before it answered"});
}

Result<NpyPlace> ModuleProcess::transfer(std::chrono::steady_clock::time_point until, std::size_t most_values) {
  const std::size_t most_bytes = most_values * sizeof(double) + 70000;
  while (true) {
    const auto found = find_message(read_, most_values);
    if (!found) return tl::unexpected(with_last_words(found.error()));
    if (*found) return **found;
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
    if (left.count() <= 0) {
      return tl::unexpected(with_last_words(
          {ErrorCode::timeout, fmt::format("the module did not answer within {} ms", options_.limit.count())}));
    }
    std::array<pollfd, 3> ends{pollfd{out_, POLLIN, 0}, pollfd{err_, POLLIN, 0},
                               pollfd{to_write_.empty() ? -1 : in_, POLLOUT, 0}};
    if (::poll(ends.data(), ends.size(), static_cast<int>(left.count())) < 0 && errno != EINTR)
      return fail(ErrorCode::internal, "a module cannot be waited for");
    if (ends[1].revents != 0) {
      take_errors();
      if ((ends[1].revents & POLLHUP) != 0) close_end(err_);
    }
    if ((ends[2].revents & (POLLOUT | POLLERR)) != 0) {
      const ssize_t done = ::write(in_, to_write_.data(), to_write_.size());
      if (done > 0) to_write_.erase(0, static_cast<std::size_t>(done));
      // A module that no longer reads may still have answered: what is left to read decides.
      if (done < 0 && errno == EPIPE) to_write_.clear();
    }
    if (ends[0].revents == 0) continue;
    const ssize_t got = ::read(out_, buffer_.data(), buffer_.size());
    if (got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR)) {
      take_errors();
      return tl::unexpected(died());
    }
    if (got > 0) read_.append(buffer_.data(), static_cast<std::size_t>(got));
    if (read_.size() > most_bytes)
      return tl::unexpected(with_last_words({ErrorCode::integrity, "the module's answer does not end"}));
  }
}

tl::unexpected<Error> ModuleProcess::refused(Error error) {
  end();
  return tl::unexpected(std::move(error));
}

Result<NpyPlace> ModuleProcess::answer_to(const std::string& messages, const std::vector<std::size_t>& shape) {
  if (process_ < 0) return fail(ErrorCode::disconnected, "the module has ended");
  // What stands there before anything was asked is no answer.
  std::array<char, 64> early{};
  if (const ssize_t got = ::read(out_, early.data(), early.size()); got > 0)
    read_.append(early.data(), static_cast<std::size_t>(got));
  if (!read_.empty()) return refused(with_last_words({ErrorCode::integrity, "the module wrote more than its answer"}));
  to_write_ += messages;
  std::size_t count = 1;
  for (const std::size_t length : shape) count *= length;
  auto found = transfer(std::chrono::steady_clock::now() + options_.limit, std::max<std::size_t>(64, 16 * count));
  if (!found) return refused(found.error());
  if (found->shape != shape) {
    return refused(
        with_last_words({ErrorCode::integrity, fmt::format("the module answered with the shape ({}), expected ({})",
                                                           fmt::join(found->shape, ", "), fmt::join(shape, ", "))}));
  }
  return found;
}

Result<cv::Mat1f> ModuleProcess::exchange(const cv::Mat1f& picture) {
  const auto found =
      answer_to(to_message(picture), {static_cast<std::size_t>(picture.rows), static_cast<std::size_t>(picture.cols)});
  if (!found) return tl::unexpected(found.error());
  cv::Mat1f answer = picture_at(read_, *found);
  read_.erase(0, found->bytes);
  // In range: neither infinite nor NaN, which compares with nothing.
  if (!cv::checkRange(answer))
    return refused(with_last_words({ErrorCode::integrity, "the module answered with a number that is not finite"}));
  return answer;
}

Result<std::vector<double>> ModuleProcess::ask(const std::string& messages, const std::vector<std::size_t>& shape) {
  const auto found = answer_to(messages, shape);
  if (!found) return tl::unexpected(found.error());
  auto read = read_message(read_, found->count);
  if (!read) return refused(read.error());
  read_.erase(0, found->bytes);
  for (const double value : read->message->values) {
    if (!std::isfinite(value))
      return refused(with_last_words({ErrorCode::integrity, "the module answered with a number that is not finite"}));
  }
  return std::move(read->message->values);
}

}  // namespace todbench
