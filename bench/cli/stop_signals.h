// Ctrl-C as a stop request.
#pragma once

#include <stop_token>
#include <thread>

namespace todbench {

/// Turns SIGINT and SIGTERM into a stop request. To be created before any other thread, which inherit the blocked
/// signals.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  [[nodiscard]] std::stop_token token() const { return stop_.get_token(); }
  /// Waits for a signal.
  void wait();

 private:
  std::stop_source stop_;
  std::jthread waiter_;
};

}  // namespace todbench
