// The time of a session: when it began by the clock on the wall, and how long ago that was by one that nobody sets.
#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace todbench {

/// Clocks of the host. Any thread.
struct HostClocks {
  using Wall = std::chrono::system_clock::time_point;
  /// UTC. May be set, by hand or from the network, while a session runs.
  std::function<Wall()> wall;
  /// Since some moment, never set; goes on while the host sleeps.
  std::function<std::chrono::nanoseconds()> monotonic;
};
/// CLOCK_REALTIME and CLOCK_BOOTTIME.
[[nodiscard]] HostClocks host_clocks();

/// ISO 8601 in whole seconds: "2026-01-31T12:34:56Z".
[[nodiscard]] std::string utc_text(HostClocks::Wall time);

/// Begins when it is made. Every duration and every time it tells comes from the monotonic clock.
class SessionClock {
 public:
  explicit SessionClock(HostClocks clocks = host_clocks());

  [[nodiscard]] std::string started_utc() const { return utc_text(started_); }
  [[nodiscard]] double passed_s() const;
  /// The start, and what has passed since.
  [[nodiscard]] std::string now_utc() const;
  /// By how much the clock on the wall is ahead of that; 0 within what slewing does to it, 1 s and 0.1 % of what has
  /// passed (NTP slews by at most 0.05 %).
  [[nodiscard]] double jump_s() const;

 private:
  [[nodiscard]] HostClocks::Wall now() const;
  HostClocks clocks_;
  HostClocks::Wall started_;
  std::chrono::nanoseconds began_;
};

/// What a report says of a jump.
[[nodiscard]] std::string jump_sentence(double jump_s);

}  // namespace todbench
