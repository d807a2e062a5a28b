// SPDX-License-Identifier: GPL-3.0-or-later
// Server-sent events of runs for several clients. One thread sends them and waits for no client. Private to
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

/// Streams of run states. Every client receives the latest state of its run as soon as it has received the previous
/// state; a slow client misses intermediate states. A client that receives no byte for 30 s is disconnected. Any
/// thread.
class EventStreams {
 public:
  /// Returns the state of a run; empty: the state of the run is no longer stored.
  using Look = std::function<std::optional<RunSnapshot>(const std::string& id)>;
  static constexpr std::size_t most_streams = 16;

  explicit EventStreams(Look look);
  ~EventStreams();
  EventStreams(const EventStreams&) = delete;
  EventStreams& operator=(const EventStreams&) = delete;

  /// Returns whether a further stream is accepted.
  [[nodiscard]] bool has_room() const;
  /// Takes ownership of the socket of a client whose response has begun. The socket is closed after the last state, or
  /// if there are too many streams.
  void add(int socket, std::string id);
  /// Reports that the state of a run has changed.
  void wake() const;
  /// Closes all streams; `look` is not called afterwards.
  void shut_down();

 private:
  using Clock = std::chrono::steady_clock;
  struct Stream {
    Descriptor socket;
    std::string id;
    std::uint64_t version = 0;
    bool over = false;
    std::string unsent{};
    Clock::time_point taken = Clock::now();  ///< time at which the client received the last byte
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
