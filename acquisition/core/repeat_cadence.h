// SPDX-License-Identifier: GPL-3.0-or-later
// Detects cameras that send each exposure several times: 60 frames a second from a sensor that exposes 30.
#pragma once

#include <cstdint>
#include <deque>
#include <string>

namespace todbench {

/// Learns how often each exposure is sent from frames that equal their predecessor bit for bit. With noise no two
/// exposures are equal, so a rhythm over 8 exposures does not arise by chance; a camera that is stuck has no rhythm.
/// One thread at a time.
class RepeatCadence {
 public:
  void see(bool equals_the_last);
  /// Frames per exposure; 1: one, or not known yet.
  [[nodiscard]] int times() const { return times_; }
  /// Whether the last frame fits the rhythm: its run is not longer than the others.
  [[nodiscard]] bool in_rhythm() const { return times_ > 1 && run_ <= times_; }
  /// Frames in the rhythm that equal their predecessor, including those from which it was learnt.
  [[nodiscard]] std::uint64_t repeats() const { return repeats_; }
  /// One sentence for the user; empty if each exposure is sent once.
  [[nodiscard]] std::string sentence() const;

 private:
  void learn();

  std::deque<int> runs_;  ///< frames of each of the last exposures, the newest last; the first one may be truncated
  int run_ = 0;           ///< frames of the present exposure
  int times_ = 1;
  std::uint64_t repeats_ = 0, before_learnt_ = 0;
};

}  // namespace todbench
