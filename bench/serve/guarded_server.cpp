// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/serve/guarded_server.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <utility>

namespace todbench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto time_to_ask = std::chrono::seconds(1);
constexpr auto time_to_answer = std::chrono::seconds(3);
/// Descriptors reserved for the run: session, recording, instruments, camera sockets.
constexpr rlim_t reserved_descriptors = 64;

/// Set while a job of this thread must close its connection at once.
thread_local bool is_one_too_many = false;

bool takes_from_the_reserve(int descriptor) {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return false;
  const rlim_t reserve = std::min(reserved_descriptors, limit.rlim_cur / 4);
  return static_cast<rlim_t>(descriptor) + reserve >= limit.rlim_cur;
}

/// Socket stream with one deadline for all reads and one for all writes.
class TimedStream : public httplib::Stream {
 public:
  explicit TimedStream(int socket) : socket_(socket) {}
  [[nodiscard]] bool is_readable() const override { return is_ready(POLLIN, asked_by_); }
  [[nodiscard]] bool is_writable() const override { return is_ready(POLLOUT, answered_by_); }
  ssize_t read(char* to, std::size_t bytes) override {
    return is_readable() ? ::recv(socket_, to, bytes, MSG_DONTWAIT) : -1;
  }
  ssize_t write(const char* from, std::size_t bytes) override {
    return is_writable() ? ::send(socket_, from, bytes, MSG_DONTWAIT | MSG_NOSIGNAL) : -1;
  }
  void get_remote_ip_and_port(std::string& ip, int& port) const override { name(::getpeername, ip, port); }
  void get_local_ip_and_port(std::string& ip, int& port) const override { name(::getsockname, ip, port); }
  [[nodiscard]] socket_t socket() const override { return socket_; }

 private:
  template <typename Ask>
  void name(Ask ask, std::string& ip, int& port) const {
    sockaddr_storage address{};
    socklen_t length = sizeof address;
    char text[INET6_ADDRSTRLEN] = {};
    if (ask(socket_, reinterpret_cast<sockaddr*>(&address), &length) != 0) return;
    if (address.ss_family == AF_INET) {
      const auto& four = reinterpret_cast<const sockaddr_in&>(address);
      ::inet_ntop(AF_INET, &four.sin_addr, text, sizeof text);
      port = ntohs(four.sin_port);
    } else if (address.ss_family == AF_INET6) {
      const auto& six = reinterpret_cast<const sockaddr_in6&>(address);
      ::inet_ntop(AF_INET6, &six.sin6_addr, text, sizeof text);
      port = ntohs(six.sin6_port);
    }
    ip = text;
  }
  [[nodiscard]] bool is_ready(short events, Clock::time_point until) const {
    for (;;) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
      if (left.count() <= 0) return false;
      pollfd one{socket_, events, 0};
      const int found = ::poll(&one, 1, static_cast<int>(left.count()));
      if (found < 0 && errno == EINTR) continue;
      return found > 0;
    }
  }

  int socket_;
  Clock::time_point asked_by_ = Clock::now() + time_to_ask;
  Clock::time_point answered_by_ = asked_by_ + time_to_answer;
};

}  // namespace

BoundedQueue::BoundedQueue() {
  for (std::size_t i = 0; i < threads; ++i) workers_.emplace_back([this] { work(); });
}

void BoundedQueue::enqueue(std::function<void()> job) {
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() < most_waiting) {
      waiting_.push_back(std::move(job));
      changed_.notify_one();
      return;
    }
  }
  is_one_too_many = true;
  job();
  is_one_too_many = false;
}

void BoundedQueue::shutdown() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

void BoundedQueue::work() {
  for (;;) {
    std::function<void()> job;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return ends_ || !waiting_.empty(); });
      if (waiting_.empty()) return;
      job = std::move(waiting_.front());
      waiting_.pop_front();
      // Connections that wait when the server ends get no answer.
      is_one_too_many = ends_;
    }
    job();
  }
}

bool GuardedServer::process_and_close_socket(socket_t socket) {
  bool done = false;
  if (!is_one_too_many && !takes_from_the_reserve(socket)) {
    TimedStream stream(socket);
    bool closed = false;
    done = process_request(stream, true, closed, nullptr);
  }
  ::shutdown(socket, SHUT_RDWR);
  ::close(socket);
  return done;
}

}  // namespace todbench
