// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run_control/event_streams.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <utility>

namespace todbench {
namespace {

constexpr auto patience = std::chrono::seconds(30);
/// A comment keeps proxies from closing an idle connection and finds clients that are gone.
constexpr auto heartbeat = std::chrono::seconds(15);
constexpr int poll_ms = 1000;
constexpr std::string_view heartbeat_line = ": waiting\n\n";

/// Discards the bytes of a client; returns false if it has closed the connection.
bool is_there(int socket) {
  std::array<char, 512> some{};
  const ssize_t got = ::recv(socket, some.data(), some.size(), MSG_DONTWAIT);
  return got > 0 || (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR));
}

}  // namespace

EventStreams::EventStreams(Look look) : look_(std::move(look)), wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  worker_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

EventStreams::~EventStreams() {
  shut_down();
}

void EventStreams::shut_down() {
  worker_.request_stop();
  wake();
  if (worker_.joinable()) worker_.join();
  const std::lock_guard lock(mutex_);
  streams_.clear();
}

bool EventStreams::has_room() const {
  const std::lock_guard lock(mutex_);
  return streams_.size() < most_streams;
}

void EventStreams::add(int socket, std::string id) {
  {
    const std::lock_guard lock(mutex_);
    Stream stream{Descriptor(socket), std::move(id)};
    if (streams_.size() < most_streams && !worker_.get_stop_token().stop_requested())
      streams_.push_back(std::move(stream));
  }
  wake();
}

void EventStreams::wake() const {
  const std::uint64_t one = 1;
  // A full counter also wakes.
  static_cast<void>(::write(wake_.get(), &one, sizeof one));
}

bool EventStreams::advance(Stream& stream) const {
  if (!is_there(stream.socket.get())) return false;
  for (;;) {
    if (stream.unsent.empty()) {
      if (stream.over) return false;
      const auto now = look_(stream.id);
      if (!now) return false;
      if (now->version != stream.version) {
        stream.version = now->version;
        stream.over = now->over;
        stream.unsent = fmt::format("id: {}\nevent: state\ndata: {}\n\n", now->version, now->json);
      } else if (Clock::now() - stream.taken > heartbeat) {
        stream.unsent = heartbeat_line;
      } else {
        return true;
      }
    }
    const ssize_t sent =
        ::send(stream.socket.get(), stream.unsent.data(), stream.unsent.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent > 0) {
      stream.unsent.erase(0, static_cast<std::size_t>(sent));
      stream.taken = Clock::now();
      continue;
    }
    if (errno == EINTR) continue;
    return (errno == EAGAIN || errno == EWOULDBLOCK) && Clock::now() - stream.taken < patience;
  }
}

void EventStreams::wait() {
  std::vector<pollfd> all{{wake_.get(), POLLIN, 0}};
  {
    const std::lock_guard lock(mutex_);
    for (const Stream& stream : streams_) {
      const bool waits = !stream.unsent.empty();
      all.push_back({stream.socket.get(), static_cast<short>(waits ? POLLIN | POLLOUT : POLLIN), 0});
    }
  }
  ::poll(all.data(), all.size(), poll_ms);
  std::uint64_t count = 0;
  static_cast<void>(::read(wake_.get(), &count, sizeof count));
}

void EventStreams::work(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    {
      // Never blocks: sends do not wait, and the lock of the queue is held briefly by all.
      const std::lock_guard lock(mutex_);
      std::erase_if(streams_, [this](Stream& stream) { return !advance(stream); });
    }
    wait();
  }
}

}  // namespace todbench
