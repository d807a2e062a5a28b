// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/base/descriptor.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>

namespace todbench {

void Descriptor::close() {
  if (fd_ >= 0) ::close(std::exchange(fd_, -1));
}

StopEvent::StopEvent(const std::stop_token& stop)
    : event_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)), callback_(stop, Signal{event_.get()}) {}

void StopEvent::Signal::operator()() const noexcept {
  const std::uint64_t one = 1;
  // A failed write means that the counter is full and the descriptor is readable already.
  [[maybe_unused]] const auto written = ::write(fd, &one, sizeof one);
}

Waited wait_on(int fd, WaitFor what, std::optional<std::chrono::steady_clock::time_point> deadline,
               const std::stop_token& stop) {
  using namespace std::chrono;
  // Longest single poll(), so that a stop is noticed within the promised second even without a stop event.
  constexpr milliseconds longest_poll{500};
  const StopEvent stop_event(stop);
  const short events = what == WaitFor::reading ? POLLIN : POLLOUT;
  for (;;) {
    if (stop.stop_requested()) return Waited::stopped;
    milliseconds left = longest_poll;
    if (deadline) left = std::clamp(ceil<milliseconds>(*deadline - steady_clock::now()), milliseconds{0}, longest_poll);
    std::array<pollfd, 2> polled{{{fd, events, 0}, {stop_event.fd(), POLLIN, 0}}};
    ::poll(polled.data(), polled.size(), static_cast<int>(left.count()));
    if (stop.stop_requested()) return Waited::stopped;
    if (polled[0].revents != 0) return Waited::ready;
    if (deadline && steady_clock::now() >= *deadline) return Waited::timeout;
  }
}

}  // namespace todbench
