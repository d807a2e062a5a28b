// A stage of the chain as a process of the user's, in any language.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "sim_devices/module/npy_message.h"

namespace todbench {

/// Whether a module may reach other computers, and this one by its network.
enum class ModuleNetwork {
  cut,  ///< a network of its own without any way out, by Debian's bubblewrap; where that cannot run: as ours
  ours,
};
/// Whether a network can be cut here: bubblewrap is installed and the system lets it work. Asked once.
[[nodiscard]] bool can_cut_network();

/// How a module is started and what it may take.
struct ModuleOptions {
  std::string command{};                  ///< for a shell
  std::string header = "{}";              ///< JSON that is sent first, as a byte array
  std::chrono::milliseconds limit{5000};  ///< for an answer, the start of the process included in the first
  std::size_t memory_limit_mib = 0;       ///< of address space, each process that it starts for itself; 0: none
  ModuleNetwork network = ModuleNetwork::cut;
  std::function<void(std::string_view line)> on_error_line{};  ///< every line of its standard error
};

/// Picture to picture: writes one .npy array to the module's standard input and reads one of the same shape from its
/// standard output. Its own process group, which ends with the object. What goes wrong is said with the last line of
/// its standard error; after an error the module is dead. The program has to ignore SIGPIPE. Move-only; one thread at a
/// time.
class ModuleProcess {
 public:
  /// `internal` where no process can be made; a command that does not exist is noticed by the first exchange.
  [[nodiscard]] static Result<ModuleProcess> start(const ModuleOptions& options);
  ModuleProcess(ModuleProcess&& other) noexcept;
  ModuleProcess& operator=(ModuleProcess&& other) = delete;
  ~ModuleProcess();

  /// `disconnected`: it died. `timeout`: no answer in time. `integrity`: no array, another shape, a type that is none,
  /// a number that is not finite, bytes behind the answer.
  [[nodiscard]] Result<cv::Mat1f> exchange(const cv::Mat1f& picture);
  /// Any messages, answered by one array of this shape; its numbers, last index fastest. Errors as exchange().
  [[nodiscard]] Result<std::vector<double>> ask(const std::string& messages, const std::vector<std::size_t>& shape);
  /// After an error: what it ended with. Nothing: it was still there, or a signal ended it.
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
  int in_ = -1, out_ = -1, err_ = -1;  ///< our ends of its standard streams
  std::string to_write_, read_, errors_, error_line_;
  std::vector<char> buffer_ = std::vector<char>(1 << 20);  ///< for reading
};

}  // namespace todbench
