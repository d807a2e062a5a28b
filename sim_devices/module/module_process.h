// SPDX-License-Identifier: GPL-3.0-or-later
// User's process, written in any language, as a stage of the chain.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/descriptor.h"
#include "acquisition/base/result.h"
#include "sim_devices/module/npy_message.h"

namespace todbench {

/// Network access of a module.
enum class ModuleNetwork {
  cut,   ///< own network and message queues, no other sockets (bubblewrap); same as `ours` if bubblewrap cannot run
  ours,  ///< the network of this program
};
/// Returns whether the network of a module can be cut on this host: bubblewrap is installed and works. Tested once.
[[nodiscard]] bool can_cut_network();

/// Command and limits of a module.
struct ModuleOptions {
  std::string command{};      ///< command for a shell
  std::string header = "{}";  ///< JSON that is sent first, as a byte array
  /// Time limit for one output. For the first output the limit includes the start of the process.
  std::chrono::milliseconds limit{5000};
  std::size_t memory_limit_mib = 0;  ///< limit of address space for each process that the module starts; 0: no limit
  ModuleNetwork network = ModuleNetwork::cut;
  std::function<void(std::string_view line)> on_error_line{};  ///< receives every line of the module's standard error
};

/// Returns the first line (at most 256 bytes) that the command writes to its standard output or error within `limit`.
/// The command runs with empty standard input under the limits of a module. Empty if it writes no line.
[[nodiscard]] std::string first_line_of_module(const ModuleOptions& options);

/// Running module: one .npy array is written to its standard input, and one array of the same shape is read from its
/// standard output. The module has its own process group, which ends with the object. Error messages contain the last
/// line of the module's standard error. After an error the module cannot be used any more. The calling program must
/// ignore SIGPIPE. Move-only; one thread at a time.
class ModuleProcess {
 public:
  /// Starts the process. Errors: `internal` if no process can be created. A command that does not exist fails in the
  /// first exchange.
  [[nodiscard]] static Result<ModuleProcess> start(const ModuleOptions& options);
  ModuleProcess(ModuleProcess&& other) noexcept;
  ModuleProcess& operator=(ModuleProcess&& other) = delete;
  ~ModuleProcess();

  /// Sends a picture and returns the output of the module. Errors: `disconnected` (the module ended), `timeout` (no
  /// output in time), `integrity` (no array, a wrong shape, an unknown type, a number that is not finite, bytes after
  /// the output).
  [[nodiscard]] Result<cv::Mat1f> exchange(const cv::Mat1f& picture);
  /// Sends messages and returns the numbers of an array of this shape, last index fastest. Errors as exchange().
  [[nodiscard]] Result<std::vector<double>> ask(const std::string& messages, const std::vector<std::size_t>& shape);
  /// Returns the exit code after an error. Empty if the process was still running or a signal ended it.
  [[nodiscard]] std::optional<int> exit_code() const { return exit_code_; }

 private:
  explicit ModuleProcess(const ModuleOptions& options) : options_(options) {}
  [[nodiscard]] Result<NpyPlace> answer_to(const std::string& messages, const std::vector<std::size_t>& shape);
  [[nodiscard]] tl::unexpected<Error> refused(Error error);
  [[nodiscard]] Result<NpyPlace> transfer(std::chrono::steady_clock::time_point until, std::size_t most_values);
  void take_errors();
  void say_lines(std::string_view words);
  [[nodiscard]] Error died() const;
  [[nodiscard]] Error with_last_words(Error error) const;
  void end();

  ModuleOptions options_;
  pid_t process_ = -1;
  std::optional<int> exit_code_;
  Descriptor in_, out_, err_;  ///< this program's ends of the standard streams of the module
  std::string to_write_, read_, errors_, error_line_;
  std::vector<char> buffer_ = std::vector<char>(1 << 20);  ///< buffer for reading
};

}  // namespace todbench
