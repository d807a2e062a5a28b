// SPDX-License-Identifier: GPL-3.0-or-later
// A program run as a user runs it: its own process, its output captured, its end awaited.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace todbench::testing {

struct ChildOptions {
  std::filesystem::path folder{};               ///< working folder; empty: that of the test
  std::map<std::string, std::string> setenv{};  ///< added to the environment of the test
  std::optional<std::uint64_t> largest_file_bytes{};
  bool one_processor = false;
  std::string standard_output{};  ///< a file to write to instead of being captured
};

/// What is left when a process has ended. `code` is the exit code, or 128 + the signal that ended it.
struct Ended {
  int code = -1;
  std::string out, err;
};

/// One process. Ended by SIGKILL when it outlives its owner. One thread at a time.
class ChildProcess {
 public:
  explicit ChildProcess(const std::vector<std::string>& command, const ChildOptions& options = {});
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  void signal(int number) const;
  /// Number of threads of the process; 0 when it has ended. The program under test starts its second thread when it is
  /// ready for signals.
  [[nodiscard]] int threads() const;
  /// Reads the output while the process runs, until `enough` says so; false when it ends first or patience does (two
  /// minutes, more on a busy machine).
  [[nodiscard]] bool wait_until(const std::function<bool()>& enough);
  /// What it wrote to standard output so far.
  [[nodiscard]] const std::string& out() const { return out_; }
  /// The same of standard error.
  [[nodiscard]] const std::string& err() const { return err_; }
  /// Waits for the end. Fails the running test when patience ends first.
  [[nodiscard]] Ended wait();

 private:
  /// Takes what is there, waiting for it at most `at_most`; false when both ends are closed.
  bool read_some(std::chrono::milliseconds at_most);
  pid_t pid_ = -1;
  int out_end_ = -1, err_end_ = -1;
  std::string out_, err_;
};

/// The program under test with these arguments, run to its end.
[[nodiscard]] Ended todbench(const std::vector<std::string>& arguments, const ChildOptions& options = {});
/// Its command line, to be started by ChildProcess.
[[nodiscard]] std::vector<std::string> todbench_command(const std::vector<std::string>& arguments);

}  // namespace todbench::testing
