// SPDX-License-Identifier: GPL-3.0-or-later
// Integrity check of the frames of a file before a result is computed from them.
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

/// Judges the numbers of damaged frames that a gate counted in `frames`, each kind of damage separately. Error:
/// `integrity` if more than 1 % of the frames have one of `damages`.
[[nodiscard]] Result<void> judge_damages(const std::map<Rejection, std::uint64_t>& rejected, std::uint64_t frames,
                                         std::span<const Rejection> damages);

/// Judges every frame of a recording of a static scene in order. The caller judges repeated frames, gaps and saturated
/// pixels, because it can determine their effect on the result.
class InputGate {
 public:
  /// Returns true if the frame is a valid exposure: a new exposure or a repetition of the previous exposure.
  [[nodiscard]] bool takes(const Frame& frame);
  /// Returns the result; call it after the last frame. Errors: `integrity` if more than 1 % of the frames are damaged.
  /// A valid recording passes: by chance, less than one frame in 10^6 appears byte-swapped, rearranged or equal to an
  /// older frame.
  [[nodiscard]] Result<void> verdict() const;
  /// Returns a sentence about the excluded frames of a recording that passes; empty if no frame was excluded.
  [[nodiscard]] std::string note() const;
  /// Returns a sentence if the camera sends each exposure several times; otherwise empty.
  [[nodiscard]] std::string cadence() const { return cadence_.sentence(); }
  /// Returns the byte order of all frames that are not incomplete or damaged.
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
