// SPDX-License-Identifier: GPL-3.0-or-later
// Clock of a session: the start by the wall clock, and the elapsed time by a monotonic clock.
#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace todbench {

/// Clocks of the host. Any thread.
struct HostClocks {
  using Wall = std::chrono::system_clock::time_point;
  /// UTC; may be set manually or by the network during a session.
  std::function<Wall()> wall;
  /// Monotonic, of arbitrary origin; continues while the host sleeps.
  std::function<std::chrono::nanoseconds()> monotonic;
};
/// Returns the clocks of the host: CLOCK_REALTIME (wall) and CLOCK_BOOTTIME (monotonic).
[[nodiscard]] HostClocks host_clocks();

/// Returns ISO 8601 in whole seconds: "2026-01-31T12:34:56Z".
[[nodiscard]] std::string utc_text(HostClocks::Wall time);

/// Clock of a session, which starts at construction. All durations and later times follow from the monotonic clock.
class SessionClock {
 public:
  explicit SessionClock(HostClocks clocks = host_clocks());

  [[nodiscard]] std::string started_utc() const { return utc_text(started_); }
  /// Returns the elapsed time in s.
  [[nodiscard]] double passed_s() const;
  /// Returns start time plus elapsed time.
  [[nodiscard]] std::string now_utc() const;
  /// Returns the time in s by which the wall clock is ahead of now_utc(). Returns 0 within the tolerance for slewing: 1
  /// s plus 0.1 % of the elapsed time (NTP slews by at most 0.05 %).
  [[nodiscard]] double jump_s() const;

 private:
  [[nodiscard]] HostClocks::Wall now() const;
  HostClocks clocks_;
  HostClocks::Wall started_;
  std::chrono::nanoseconds began_;
};

/// Returns the sentence of the report about a jump.
[[nodiscard]] std::string jump_sentence(double jump_s);

}  // namespace todbench
