// SPDX-License-Identifier: GPL-3.0-or-later
// Transfer of an operator request from the run to the window, and of the answer back.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>
#include <utility>

#include "acquisition/base/result.h"
#include "tod/presentation/operator_request.h"

namespace todbench {

/// Exchange between the run, which waits, and the window, which answers. Thread-safe.
class OperatorRequests {
 public:
  /// Waits for answer(). Errors: `interrupted` as soon as stop is requested.
  [[nodiscard]] Result<OperatorAnswer> wait(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    if (!answered_.wait(lock, stop, [this] { return answer_.has_value(); }))
      return fail(ErrorCode::interrupted, "stopped while waiting for the operator");
    return *std::exchange(answer_, std::nullopt);
  }
  /// Discards an earlier answer. Call it before the request is shown.
  void clear() {
    const std::lock_guard lock(mutex_);
    answer_.reset();
  }
  /// Passes the answer to the run.
  void answer(OperatorAnswer answer) {
    {
      const std::lock_guard lock(mutex_);
      answer_ = answer;
    }
    answered_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable_any answered_;
  std::optional<OperatorAnswer> answer_;
};

}  // namespace todbench
