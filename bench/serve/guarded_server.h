// SPDX-License-Identifier: GPL-3.0-or-later
// HTTP server that protects the run's file descriptors and time from its clients. For bench/serve and
// bench/run_control.
#pragma once

#include <httplib.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/serve/serve_address.h"

namespace todbench {

/// Queue that serves a few connections at a time and keeps a few waiting. The accepting thread closes any further one.
class BoundedQueue : public httplib::TaskQueue {
 public:
  static constexpr std::size_t threads = 4, most_waiting = 16;
  BoundedQueue();
  void enqueue(std::function<void()> job) override;
  void shutdown() override;

 private:
  void work();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> waiting_;
  bool ends_ = false;
  std::vector<std::thread> workers_;
};

/// Server with one request per connection, which must arrive within one second and be sent within three from its first
/// byte. A connection is closed if its descriptor is among the last available to the process, because the run needs
/// them.
class GuardedServer : public httplib::Server {
 public:
  GuardedServer();
  /// For handlers: `take` gets the socket of this request, and owns it, once the answer is sent. Otherwise it is
  /// closed.
  static void hand_over(std::function<void(int socket)> take);
  /// For handlers: time to send the answer beyond the three seconds, for large files.
  static void allow_more_time(std::chrono::milliseconds more);
  /// Listens in a thread of its own, after bind_to(). Returns when it can be stopped.
  void start_listening();
  /// Ends that thread; without one it has no effect. The owner calls it before anything that handlers use is destroyed.
  void stop_listening();

 private:
  bool process_and_close_socket(socket_t socket) override;
  std::atomic<bool> ended_ = false;
  std::thread thread_;
};

/// Sets headers that forbid external resources, embedding in frames, and a referrer with the token.
void guard(httplib::Response& response);
/// The same for a file of a session: a report has its style and pictures in itself, and runs no script.
void guard_report(httplib::Response& response);
/// Returns 128 random bits as text from the system's random source, not from the seed of the experiment: they must not
/// be predictable.
[[nodiscard]] std::string random_token();
/// Binds to the address, port 0: any free one. Returns the port. Errors: `io` (port in use, or not an address of this
/// computer).
[[nodiscard]] Result<int> bind_to(GuardedServer& server, const ServeAddress& address);
/// Returns "http://127.0.0.1:8080/".
[[nodiscard]] std::string url_of(const ServeAddress& address, int port);

}  // namespace todbench
