// SPDX-License-Identifier: GPL-3.0-or-later
// A time base that tests move themselves.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>

namespace todbench {

/// Stands still until advanced, or moves on by `tick_s` with every reading. Copies share the time. Thread-safe.
class FakeClock {
 public:
  explicit FakeClock(double tick_s = 0)
      : tick_(in_ns(tick_s)), now_ns_(std::make_shared<std::atomic<std::int64_t>>(in_ns(1'000'000))) {}
  void advance(double time_s) { now_ns_->fetch_add(in_ns(time_s)); }
  [[nodiscard]] std::function<std::chrono::steady_clock::time_point()> now() const {
    return [tick = tick_, shared = now_ns_] {
      return std::chrono::steady_clock::time_point(std::chrono::nanoseconds(shared->fetch_add(tick)));
    };
  }

 private:
  static std::int64_t in_ns(double time_s) { return static_cast<std::int64_t>(time_s * 1e9); }
  std::int64_t tick_;
  std::shared_ptr<std::atomic<std::int64_t>> now_ns_;
};

}  // namespace todbench
