// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/module/module_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <utility>

#include <fmt/format.h>

#include "acquisition/base/process.h"
#include "acquisition/base/safe_text.h"
#include "acquisition/base/try.h"
#include "sim_devices/module/module_filter.h"
#include "sim_devices/module/npy_message.h"

namespace todbench {
namespace {

constexpr std::size_t kept_errors = 4096;

void never_wait(int descriptor) {
  ::fcntl(descriptor, F_SETFL, ::fcntl(descriptor, F_GETFL) | O_NONBLOCK);
}

/// File descriptor at which bwrap finds the filter.
constexpr int filter_end = 3;

/// Own network without sockets that lead out of it, own System V objects and POSIX message queues. The file system is
/// that of the host; all processes end with the first.
std::vector<std::string> sandbox_words() {
  // Not --die-with-parent: the module would die with its starting thread. A bench that ends closes the input.
  return {"bwrap",         "--dev-bind", "/",     "/",         "--unshare-net",           "--unshare-ipc",
          "--unshare-pid", "--proc",     "/proc", "--seccomp", std::to_string(filter_end)};
}

bool is_in_sandbox(const ModuleOptions& options) {
  return options.network == ModuleNetwork::cut && can_cut_network();
}

/// Shell command line of the module.
std::vector<std::string> words_of(const ModuleOptions& options) {
  std::vector<std::string> words;
  if (is_in_sandbox(options)) words = sandbox_words();
  const std::string limit =
      options.memory_limit_mib == 0 ? "" : fmt::format("ulimit -v {} || exit 1\n", options.memory_limit_mib * 1024);
  words.insert(words.end(), {"/bin/sh", "-c", limit + options.command});
  return words;
}

enum class Sandbox { none, filtered };

/// Starts a process group with these standard streams and no blocked signal.
Result<pid_t> spawned_group(std::vector<std::string> words, Sandbox sandbox, const Pipe& in, const Pipe& out,
                            const Pipe& err) {
  const Descriptor filter(sandbox == Sandbox::filtered ? module_filter() : -1);
  if (sandbox == Sandbox::filtered && !filter.is_open())
    return fail(ErrorCode::internal, "the system-call filter of the module cannot be created");
  const auto process = start_program(
      std::move(words),
      {.input = in.read.get(), .output = out.write.get(), .error = err.write.get(), .at_three = filter.get()},
      ChildGroup::own);
  if (!process) return fail(ErrorCode::internal, "the process of the module cannot be started");
  return process;
}

/// Starts a process and reads the first line from either of its outputs, for at most `limit`, then ends it. The exit
/// code is set if the process ended before.
struct Said {
  std::string line;
  std::optional<int> exit_code;
};
Result<Said> first_line_said(std::vector<std::string> words, Sandbox sandbox, std::chrono::milliseconds limit) {
  auto in = make_pipe(), out = make_pipe();
  if (!in || !out) return fail(ErrorCode::internal, "the pipe to the module cannot be created");
  const auto process = spawned_group(std::move(words), sandbox, *in, *out, *out);
  in->read.close();
  in->write.close();
  out->write.close();
  Said said;
  const auto until = std::chrono::steady_clock::now() + limit;
  constexpr std::size_t longest_line = 256;
  bool at_end = false;
  while (process && !at_end && said.line.size() < longest_line && said.line.find('\n') == std::string::npos) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
    pollfd readable{out->read.get(), POLLIN, 0};
    if (left.count() <= 0 || ::poll(&readable, 1, static_cast<int>(left.count())) == 0) break;
    std::array<char, longest_line> piece{};
    const ssize_t got = ::read(out->read.get(), piece.data(), piece.size());
    if (got < 0 && errno == EINTR) continue;
    at_end = got <= 0;
    if (got > 0) said.line.append(piece.data(), static_cast<std::size_t>(got));
  }
  out->read.close();
  if (!process) return tl::unexpected(process.error());
  int status = 0;
  bool ended = false;
  // The process may have closed its output and still run.
  while (at_end && !ended && std::chrono::steady_clock::now() < until) {
    ended = ::waitpid(*process, &status, WNOHANG) == *process;
    if (!ended) ::poll(nullptr, 0, 1);
  }
  if (!ended) {
    ::kill(-*process, SIGKILL);
    while (::waitpid(*process, &status, 0) < 0 && errno == EINTR) {
    }
  }
  // Ends everything that it left running in its group.
  ::kill(-*process, SIGKILL);
  if (ended && WIFEXITED(status)) said.exit_code = WEXITSTATUS(status);
  said.line = said.line.substr(0, std::min(said.line.find('\n'), longest_line));
  return said;
}

}  // namespace

bool can_cut_network() {
  static const bool can = [] {
    auto words = sandbox_words();
    words.emplace_back("true");
    const auto said = first_line_said(std::move(words), Sandbox::filtered, std::chrono::seconds(10));
    return said && said->exit_code == 0;
  }();
  return can;
}

std::string first_line_of_module(const ModuleOptions& options) {
  const auto said =
      first_line_said(words_of(options), is_in_sandbox(options) ? Sandbox::filtered : Sandbox::none, options.limit);
  return said ? said->line : std::string();
}

Result<ModuleProcess> ModuleProcess::start(const ModuleOptions& options) {
  auto in = make_pipe(), out = make_pipe(), err = make_pipe();
  for (const auto* pipe : {&in, &out, &err}) {
    if (!*pipe) return tl::unexpected(pipe->error());
  }
  auto process =
      spawned_group(words_of(options), is_in_sandbox(options) ? Sandbox::filtered : Sandbox::none, *in, *out, *err);
  in->read.close();
  out->write.close();
  err->write.close();
  ModuleProcess module(options);
  module.in_ = std::move(in->write);
  module.out_ = std::move(out->read);
  module.err_ = std::move(err->read);
  if (!process) return tl::unexpected(process.error());
  module.process_ = *process;
  for (const int end : {module.in_.get(), module.out_.get(), module.err_.get()}) never_wait(end);
  // A whole picture at once if the system allows it, for fewer switches between the two processes.
  constexpr int picture_bytes = 1 << 20;
  for (const int end : {module.in_.get(), module.out_.get()}) ::fcntl(end, F_SETPIPE_SZ, picture_bytes);
  module.to_write_ = to_message(std::string_view(options.header));
  return module;
}

ModuleProcess::ModuleProcess(ModuleProcess&& other) noexcept
    : options_(std::move(other.options_)),
      process_(std::exchange(other.process_, -1)),
      exit_code_(other.exit_code_),
      in_(std::move(other.in_)),
      out_(std::move(other.out_)),
      err_(std::move(other.err_)),
      to_write_(std::move(other.to_write_)),
      read_(std::move(other.read_)),
      errors_(std::move(other.errors_)),
      error_line_(std::move(other.error_line_)),
      buffer_(std::move(other.buffer_)) {}

ModuleProcess::~ModuleProcess() {
  end();
}

void ModuleProcess::end() {
  in_.close();
  out_.close();
  err_.close();
  if (process_ < 0) return;
  // Ends everything that it started, which belongs to its group.
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
    // Keeps only the beginning of an endless line.
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
  for (ssize_t got = 0; (got = ::read(err_.get(), buffer.data(), buffer.size())) > 0;) {
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
  if (!line.empty()) error.message += "; its last output: " + one_line(std::string(line));
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
    std::array<pollfd, 3> ends{pollfd{out_.get(), POLLIN, 0}, pollfd{err_.get(), POLLIN, 0},
                               pollfd{to_write_.empty() ? -1 : in_.get(), POLLOUT, 0}};
    if (::poll(ends.data(), ends.size(), static_cast<int>(left.count())) < 0 && errno != EINTR)
      return fail(ErrorCode::internal, "waiting for the module failed");
    if (ends[1].revents != 0) {
      take_errors();
      if ((ends[1].revents & POLLHUP) != 0) err_.close();
    }
    if ((ends[2].revents & (POLLOUT | POLLERR)) != 0) {
      const ssize_t done = ::write(in_.get(), to_write_.data(), to_write_.size());
      if (done > 0) to_write_.erase(0, static_cast<std::size_t>(done));
      // A module that stopped reading may still have answered: the remaining input decides.
      if (done < 0 && errno == EPIPE) to_write_.clear();
    }
    if (ends[0].revents == 0) continue;
    const ssize_t got = ::read(out_.get(), buffer_.data(), buffer_.size());
    if (got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR)) {
      take_errors();
      return tl::unexpected(died());
    }
    if (got > 0) read_.append(buffer_.data(), static_cast<std::size_t>(got));
    if (read_.size() > most_bytes)
      return tl::unexpected(with_last_words({ErrorCode::integrity, "the module's answer is too long"}));
  }
}

tl::unexpected<Error> ModuleProcess::refused(Error error) {
  end();
  return tl::unexpected(std::move(error));
}

Result<NpyPlace> ModuleProcess::answer_to(const std::string& messages, const std::vector<std::size_t>& shape) {
  if (process_ < 0) return fail(ErrorCode::disconnected, "the module has ended");
  // Output in front of the first request is not an answer.
  std::array<char, 64> early{};
  if (const ssize_t got = ::read(out_.get(), early.data(), early.size()); got > 0)
    read_.append(early.data(), static_cast<std::size_t>(got));
  if (!read_.empty())
    return refused(with_last_words({ErrorCode::integrity, "the module wrote more bytes than its answer"}));
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
  // Rejects infinite values and NaN, which fails every comparison.
  if (!cv::checkRange(answer))
    return refused(with_last_words({ErrorCode::integrity, "the module answered with a number that is not finite"}));
  return answer;
}

Result<std::vector<double>> ModuleProcess::ask(const std::string& messages, const std::vector<std::size_t>& shape) {
  TODBENCH_TRY(const auto found, answer_to(messages, shape));
  auto read = read_message(read_, found.count);
  if (!read) return refused(read.error());
  read_.erase(0, found.bytes);
  for (const double value : read->message->values) {
    if (!std::isfinite(value))
      return refused(with_last_words({ErrorCode::integrity, "the module answered with a number that is not finite"}));
  }
  return std::move(read->message->values);
}

}  // namespace todbench
