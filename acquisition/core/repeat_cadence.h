// SPDX-License-Identifier: GPL-3.0-or-later
// Detects cameras that send each exposure several times, e.g. 60 frames per second from a sensor that exposes 30.
#pragma once

#include <cstdint>
#include <deque>
#include <string>

namespace todbench {

/// Determines how often a camera sends each exposure, from frames that equal the preceding frame bit for bit. Because
/// of noise, no two exposures are equal. A regular pattern of repetitions over 8 exposures therefore does not arise by
/// chance. A camera that is stuck shows no regular pattern. One thread at a time.
class RepeatCadence {
 public:
  void see(bool equals_the_last);
  /// Returns the frames per exposure; 1 while the number is unknown.
  [[nodiscard]] int times() const { return times_; }
  /// Returns whether the last frame agrees with the regular pattern: its exposure was not sent more often than other
  /// exposures.
  [[nodiscard]] bool in_rhythm() const { return times_ > 1 && run_ <= times_; }
  /// Returns the number of frames in the regular pattern that equal the preceding frame, including the frames from
  /// which the pattern was determined.
  [[nodiscard]] std::uint64_t repeats() const { return repeats_; }
  /// Returns one sentence for the user; empty if each exposure is sent once.
  [[nodiscard]] std::string sentence() const;

 private:
  void learn();

  std::deque<int> runs_;  ///< frames of each of the last exposures, the newest last; the first number may be too small
  int run_ = 0;           ///< frames of the present exposure
  int times_ = 1;
  std::uint64_t repeats_ = 0, before_learnt_ = 0;
};

}  // namespace todbench
