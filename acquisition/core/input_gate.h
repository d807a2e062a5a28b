// SPDX-License-Identifier: GPL-3.0-or-later
// Integrity check before a number is computed from the frames of a file.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>

#include "acquisition/core/byte_order.h"
#include "acquisition/core/frame.h"
#include "acquisition/core/integrity_gate.h"
#include "acquisition/core/moved_picture.h"
#include "acquisition/core/repeat_cadence.h"

namespace todbench {

/// Judges the damages that a gate counted in so many frames, each alone. Error: `integrity` if more than 1 % of the
/// frames have one of `damages`.
[[nodiscard]] Result<void> judge_damages(const std::map<Rejection, std::uint64_t>& rejected, std::uint64_t frames,
                                         std::span<const Rejection> damages);

/// Judges every frame of a recording of a static scene in order. Repeated frames, gaps and pixels at an end of the
/// counts are left to the caller, who knows their effect on the number.
class InputGate {
 public:
  /// Returns whether the frame is a valid exposure, new or a repetition of the previous one.
  [[nodiscard]] bool takes(const Frame& frame);
  /// Returns the result; call it after the last frame. Errors: `integrity` if more than 1 % of the frames are damaged.
  /// A valid recording passes: less than one frame in 10^6 appears byte-swapped, rearranged or equal to an older one by
  /// chance.
  [[nodiscard]] Result<void> verdict() const;
  /// Returns a sentence about the frames left out of a recording that passes; empty if there are none.
  [[nodiscard]] std::string note() const;
  /// Returns a sentence if the camera sends each exposure several times; otherwise empty.
  [[nodiscard]] std::string cadence() const { return cadence_.sentence(); }
  /// Byte order of all frames that are not incomplete or damaged.
  [[nodiscard]] const ByteOrderWatch& byte_order() const { return byte_order_; }

 private:
  IntegrityGate gate_{IntegrityOptions{}};
  MovedPicture moved_;
  std::string how_moved_;
  std::uint64_t frames_ = 0;
  std::map<Rejection, std::uint64_t> damaged_;
  std::uint64_t moved_frames_ = 0;
  RepeatCadence cadence_;
  ByteOrderWatch byte_order_;
};

}  // namespace todbench
