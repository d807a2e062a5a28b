// SPDX-License-Identifier: GPL-3.0-or-later
// HTTP server that protects the run's file descriptors and time from its clients. Private to bench/serve.
#pragma once

#include <httplib.h>

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

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

/// Server with one request per connection, which must arrive within one second and be answered within three. A
/// connection is closed if its descriptor is among the last available to the process, because the run needs them.
class GuardedServer : public httplib::Server {
 private:
  bool process_and_close_socket(socket_t socket) override;
};

}  // namespace todbench
