// SPDX-License-Identifier: GPL-3.0-or-later
// Server-sent events of runs to several clients, from one thread that waits for none of them. Private to
// bench/run_control.
#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "acquisition/base/descriptor.h"
#include "bench/run_control/run_queue.h"

namespace todbench {

/// Every client gets the latest state of its run as soon as it has taken the one before; a slow client misses states in
/// between. A client that takes no byte for 30 s is disconnected. Any thread.
class EventStreams {
 public:
  /// Returns the state of a run; empty: the run is not kept any more.
  using Look = std::function<std::optional<RunSnapshot>(const std::string& id)>;
  static constexpr std::size_t most_streams = 16;

  explicit EventStreams(Look look);
  ~EventStreams();
  EventStreams(const EventStreams&) = delete;
  EventStreams& operator=(const EventStreams&) = delete;

  [[nodiscard]] bool has_room() const;
  /// Takes the socket of a client whose answer has begun. It is closed after the last state, or if there is no room.
  void add(int socket, std::string id);
  /// The state of a run has changed.
  void wake() const;
  /// Closes all streams; `look` is not called after it.
  void shut_down();

 private:
  using Clock = std::chrono::steady_clock;
  struct Stream {
    Descriptor socket;
    std::string id;
    std::uint64_t version = 0;
    bool over = false;
    std::string unsent{};
    Clock::time_point taken = Clock::now();  ///< last byte that the client took
  };
  void work(const std::stop_token& stop);
  void wait();
  /// Returns false if the stream is over.
  [[nodiscard]] bool advance(Stream& stream) const;

  Look look_;
  mutable std::mutex mutex_;
  std::vector<Stream> streams_;
  Descriptor wake_;
  std::jthread worker_;  // last: it uses everything above
};

}  // namespace todbench
