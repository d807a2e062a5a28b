// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/session_clock.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <ctime>
#include <utility>

namespace todbench {
namespace {

std::chrono::nanoseconds boot_time() {
  std::timespec time{};
  ::clock_gettime(CLOCK_BOOTTIME, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

}  // namespace

HostClocks host_clocks() {
  return {.wall = [] { return std::chrono::system_clock::now(); }, .monotonic = boot_time};
}

std::string utc_text(HostClocks::Wall time) {
  const std::time_t seconds = std::chrono::system_clock::to_time_t(std::chrono::floor<std::chrono::seconds>(time));
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  std::array<char, 32> text{};
  const std::size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return {text.data(), length};
}

SessionClock::SessionClock(HostClocks clocks)
    : clocks_(std::move(clocks)), started_(clocks_.wall()), began_(clocks_.monotonic()) {}

double SessionClock::passed_s() const {
  return std::chrono::duration<double>(clocks_.monotonic() - began_).count();
}

HostClocks::Wall SessionClock::now() const {
  return started_ + std::chrono::duration_cast<HostClocks::Wall::duration>(clocks_.monotonic() - began_);
}

std::string SessionClock::now_utc() const {
  return utc_text(now());
}

double SessionClock::jump_s() const {
  const double ahead_s = std::chrono::duration<double>(clocks_.wall() - now()).count();
  return std::abs(ahead_s) > 1 + 1e-3 * passed_s() ? ahead_s : 0;
}

std::string jump_sentence(double jump_s) {
  return fmt::format(
      "the clock of the host was changed during the session and is now {:.1f} s {}. The times of the session come from "
      "a clock that cannot be set",
      std::abs(jump_s), jump_s > 0 ? "ahead" : "behind");
}

}  // namespace todbench
