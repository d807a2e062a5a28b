// SPDX-License-Identifier: GPL-3.0-or-later
// Transfer of frames from the acquiring thread to the live picture: the latest frame, and counters of all frames.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "acquisition/core/frame_source.h"
#include "acquisition/core/integrity_gate.h"

namespace todbench {

/// Counters since the feed was opened.
struct FrameCounters {
  std::uint64_t good = 0, lost = 0;
  std::map<std::string, std::uint64_t> rejected;  ///< by reason
  double rate_hz = 0;                             ///< frame rate over the last second; 0: not yet known
};

/// Latest frame with the counters.
struct LiveFrame {
  Frame frame;
  FrameCounters counters;
};

/// Feed that the acquiring thread writes and the window reads. Thread-safe.
class LiveFeed {
 public:
  /// Registers a newly opened camera and resets the counters to zero.
  void open(const SourceInfo& info);
  /// Adds a frame.
  void put(const Frame& frame);
  /// Returns the latest frame once; empty if it was already returned.
  [[nodiscard]] std::optional<LiveFrame> take();
  /// Returns the description of the last opened camera.
  [[nodiscard]] std::optional<SourceInfo> info() const;

 private:
  mutable std::mutex mutex_;
  std::optional<SourceInfo> info_;
  std::optional<IntegrityGate> gate_;
  std::deque<std::int64_t> arrivals_ns_;
  std::optional<LiveFrame> latest_;
};

}  // namespace todbench
