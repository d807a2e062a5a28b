// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/serve/guarded_server.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <random>
#include <utility>

namespace todbench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto time_to_ask = std::chrono::seconds(1);
constexpr auto time_to_answer = std::chrono::seconds(3);
/// Descriptors reserved for the run: session, recording, instruments, camera sockets.
constexpr rlim_t reserved_descriptors = 64;

/// Unread bytes that are awaited after an answer: a close with unread bytes resets the connection, and the client would
/// lose the answer.
constexpr std::size_t most_unread = std::size_t{1} << 20;
constexpr auto time_to_drain = std::chrono::milliseconds(300);

/// Set while a job of this thread must close its connection at once.
thread_local bool is_one_too_many = false;
/// Set by the handler of the request that this thread answers.
thread_local std::function<void(int)> taker;
thread_local std::chrono::milliseconds more_time{0};

void drain(int socket) {
  std::array<char, 4096> some{};
  if (::recv(socket, some.data(), 1, MSG_PEEK | MSG_DONTWAIT) <= 0) return;
  ::shutdown(socket, SHUT_WR);
  const auto until = Clock::now() + time_to_drain;
  for (std::size_t unread = 0; unread < most_unread;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
    pollfd one{socket, POLLIN, 0};
    if (left.count() <= 0 || ::poll(&one, 1, static_cast<int>(left.count())) <= 0) return;
    const ssize_t got = ::recv(socket, some.data(), some.size(), MSG_DONTWAIT);
    if (got <= 0) return;
    unread += static_cast<std::size_t>(got);
  }
}

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
  [[nodiscard]] bool is_writable() const override {
    if (answered_by_ == Clock::time_point()) answered_by_ = Clock::now() + time_to_answer + more_time;
    return is_ready(POLLOUT, answered_by_);
  }
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
  mutable Clock::time_point answered_by_{};  ///< set by the first write: an answer may take time to find
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

GuardedServer::GuardedServer() {
  new_task_queue = [] { return new BoundedQueue; };
  set_tcp_nodelay(true);
  // SO_REUSEADDR instead of the library's SO_REUSEPORT, with which another program could listen on the same port.
  set_socket_options([](socket_t socket) {
    const int on = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  });
}

void GuardedServer::hand_over(std::function<void(int)> take) {
  taker = std::move(take);
}

void GuardedServer::allow_more_time(std::chrono::milliseconds more) {
  more_time = more;
}

namespace {

void guard_with(httplib::Response& response, const char* policy) {
  response.set_header("Content-Security-Policy", policy);
  response.set_header("Referrer-Policy", "no-referrer");
  response.set_header("X-Content-Type-Options", "nosniff");
  response.set_header("Cache-Control", "no-store");
}

}  // namespace

void guard(httplib::Response& response) {
  guard_with(response,
             "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
             "img-src 'self' data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
}

void guard_report(httplib::Response& response) {
  guard_with(response,
             "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'; "
             "frame-ancestors 'none'; sandbox");
}

std::string random_token() {
  std::random_device device;
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", device());
  return token;
}

Result<int> bind_to(GuardedServer& server, const ServeAddress& address) {
  const int port = address.port == 0                                 ? server.bind_to_any_port(address.host)
                   : server.bind_to_port(address.host, address.port) ? address.port
                                                                     : -1;
  if (port > 0) return port;
  return fail(ErrorCode::io,
              fmt::format("{}:{} cannot be used: the port is in use, or the address is not one of this computer",
                          address.host, address.port));
}

std::string url_of(const ServeAddress& address, int port) {
  const bool six = address.host.find(':') != std::string::npos;
  return fmt::format("http://{}:{}/", six ? "[" + address.host + "]" : address.host, port);
}

void GuardedServer::start_listening() {
  thread_ = std::thread([this] {
    listen_after_bind();
    ended_ = true;
  });
  // A server that is not running yet cannot be stopped, and the library has no signal for it.
  while (!is_running() && !ended_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

void GuardedServer::stop_listening() {
  if (!thread_.joinable()) return;
  stop();
  thread_.join();
}

bool GuardedServer::process_and_close_socket(socket_t socket) {
  bool done = false;
  taker = nullptr;
  more_time = {};
  if (!is_one_too_many && !takes_from_the_reserve(socket)) {
    TimedStream stream(socket);
    bool closed = false;
    done = process_request(stream, true, closed, nullptr);
    if (const auto take = std::exchange(taker, nullptr); done && take) {
      take(socket);
      return true;
    }
    drain(socket);
  }
  ::shutdown(socket, SHUT_RDWR);
  ::close(socket);
  return done;
}

}  // namespace todbench
