// SPDX-License-Identifier: GPL-3.0-or-later
// Ctrl-C as a stop request.
#pragma once

#include <atomic>
#include <stop_token>
#include <thread>

namespace todbench {

/// Turns SIGINT, SIGTERM and SIGHUP into a stop request, except signals that the parent process set to be ignored
/// (nohup, background jobs). A second signal ends the process immediately with exit code 130. The first signal also
/// ends it if no code has called observe(), token() or wait(): a short command need not look at the request. Create it
/// before any other thread starts, because threads inherit the blocked signals.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  /// The caller will look at the stop request, so the first signal does not end the process.
  void observe() { observed_ = true; }
  /// Returns the token of the stop request.
  [[nodiscard]] std::stop_token token() {
    observe();
    return stop_.get_token();
  }
  /// Waits for a signal.
  void wait();

 private:
  std::stop_source stop_;
  std::atomic<bool> leaving_{false}, observed_{false};
  std::jthread waiter_;
};

}  // namespace todbench
