// SPDX-License-Identifier: GPL-3.0-or-later
// Owned POSIX file descriptors, and waits that end immediately on a stop request.
#pragma once

#include <chrono>
#include <optional>
#include <stop_token>
#include <utility>

namespace todbench {

/// Owns one file descriptor; -1 if none.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    if (this != &other) {
      close();
      fd_ = std::exchange(other.fd_, -1);
    }
    return *this;
  }
  ~Descriptor() { close(); }

  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] bool is_open() const { return fd_ >= 0; }
  void close();

 private:
  int fd_ = -1;
};

/// A descriptor that becomes readable on a stop request: add it to a poll() with the other descriptors. Create and
/// destroy it on the waiting thread.
class StopEvent {
 public:
  explicit StopEvent(const std::stop_token& stop);
  /// Returns -1 if the system provided no descriptor: poll() then ignores it, and the stop is noticed at the next
  /// deadline.
  [[nodiscard]] int fd() const { return event_.get(); }

 private:
  struct Signal {
    int fd;
    void operator()() const noexcept;
  };
  Descriptor event_;
  std::stop_callback<Signal> callback_;
};

/// Reason why wait_on() returned.
enum class Waited { ready, timeout, stopped };
/// Event that wait_on() waits for.
enum class WaitFor { reading, writing };

/// Waits until the descriptor can be read or written (or has an error or end of file to report), at most until
/// `deadline`; without a deadline it waits indefinitely.
[[nodiscard]] Waited wait_on(int fd, WaitFor what, std::optional<std::chrono::steady_clock::time_point> deadline,
                             const std::stop_token& stop);

}  // namespace todbench
