// SPDX-License-Identifier: GPL-3.0-or-later
// HTTP server with limits on file descriptors and time, so that clients cannot disturb a run. For bench/serve and
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

/// Queue that serves a few connections at a time and lets a few wait. The accepting thread closes any further
/// connection.
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

/// Server with one request per connection. The request must arrive within one second, and the response must be sent
/// within three seconds after its first byte. The server closes a connection if its file descriptor is among the last
/// available to the process, because the run needs these descriptors.
class GuardedServer : public httplib::Server {
 public:
  GuardedServer();
  /// For handlers: passes the socket of this request to `take` after the response is sent. `take` then owns the socket.
  /// Without this call the socket is closed.
  static void hand_over(std::function<void(int socket)> take);
  /// For handlers: extends the three seconds for sending the response, for large files.
  static void allow_more_time(std::chrono::milliseconds more);
  /// Listens on its own thread, after bind_to(). Returns as soon as stop_listening() can be called.
  void start_listening();
  /// Ends the thread of start_listening(), if there is one. The owner calls it before objects that handlers use are
  /// destroyed.
  void stop_listening();

 private:
  bool process_and_close_socket(socket_t socket) override;
  std::atomic<bool> ended_ = false;
  std::thread thread_;
};

/// Sets headers that forbid external resources, embedding in frames, and referrers (which would reveal the token).
void guard(httplib::Response& response);
/// Sets the headers for a file of a session, which contains its style and pictures and runs no script.
void guard_report(httplib::Response& response);
/// Returns 128 random bits as text. The bits come from the random source of the system and not from the seed of the
/// experiment, because they must not be predictable.
[[nodiscard]] std::string random_token();
/// Binds to the address and returns the port. Port 0 selects any free port. Errors: `io` (port in use, or not an
/// address of this computer).
[[nodiscard]] Result<int> bind_to(GuardedServer& server, const ServeAddress& address);
/// Returns "http://127.0.0.1:8080/".
[[nodiscard]] std::string url_of(const ServeAddress& address, int port);

}  // namespace todbench
