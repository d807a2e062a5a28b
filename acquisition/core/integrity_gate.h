// SPDX-License-Identifier: GPL-3.0-or-later
// Decides which frames may be measured. All others are counted by reason and never used.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "acquisition/core/frame.h"

namespace todbench {

/// Reason for rejecting a frame.
enum class Rejection {
  incomplete,                ///< reported by the transport
  wrong_size,                ///< differs from the geometry of the source
  repeated,                  ///< the same sequence number as the last frame, or the same pixels as a recent frame
  out_of_order,              ///< the sequence number is below the last sequence number
  gapped,                    ///< exposures are missing directly before this frame
  frozen,                    ///< bit-identical to the preceding frame (shutter, stuck transfer)
  saturated,                 ///< more than the permitted share of pixels at zero or full scale
  byte_swapped,              ///< the picture shows that its bytes are swapped
  nonuniformity_correction,  ///< during or shortly after a correction
};
inline constexpr Rejection all_rejections[] = {
    Rejection::incomplete,   Rejection::wrong_size,   Rejection::repeated,
    Rejection::out_of_order, Rejection::gapped,       Rejection::frozen,
    Rejection::saturated,    Rejection::byte_swapped, Rejection::nonuniformity_correction};

[[nodiscard]] std::string_view to_string(Rejection reason);

/// Inconsistencies of the frame numbers, and losses caused by the program.
struct NumberingFaults {
  std::uint64_t restarts = 0;        ///< Numbering::restarted
  std::uint64_t silent_gaps = 0;     ///< Numbering::timed
  std::uint64_t estimated_lost = 0;  ///< missing exposures in both cases; included in lost()
  std::uint64_t unread = 0;          ///< missing exposures before Numbering::unread; included in lost()
  bool operator==(const NumberingFaults&) const = default;
};

/// Returns one sentence about the faults; empty if there are none.
[[nodiscard]] std::string describe(const NumberingFaults& faults);

/// Options of IntegrityGate.
struct IntegrityOptions {
  int width = 0, height = 0;          ///< expected geometry; 0: not checked
  double max_saturated_share = 0.01;  ///< permitted share of saturated pixels
  /// False only for a simulated sensor without noise: its frames are equal by design and do not indicate a correction.
  bool reject_frozen = true;
};

/// Examines every frame in order of arrival. One thread at a time.
class IntegrityGate {
 public:
  explicit IntegrityGate(IntegrityOptions options);
  /// Returns the first reason to reject the frame; empty if it may be measured. Counts the frame in both cases.
  [[nodiscard]] std::optional<Rejection> judge(const Frame& frame);
  /// Revokes the acceptance of the last frame for a reason that only the caller detects (time since a correction).
  void reject_accepted(Rejection reason);
  /// Counts the frame that judge() has just rejected under the reason `to` instead of `from`. Use it for a reason that
  /// only the caller detects.
  void recount(Rejection from, Rejection to);

  [[nodiscard]] std::uint64_t accepted() const { return accepted_; }
  [[nodiscard]] std::uint64_t rejected() const;
  [[nodiscard]] const std::map<Rejection, std::uint64_t>& rejected_by_reason() const { return rejected_; }
  /// Returns the number of exposures that never arrived: the sum of the gaps in the sequence, including
  /// NumberingFaults::unread.
  [[nodiscard]] std::uint64_t lost() const { return lost_; }
  /// Returns the inconsistencies between the camera's numbers and the elapsed time, and the part of lost() that is
  /// estimated from time.
  [[nodiscard]] const NumberingFaults& numbering() const { return numbering_; }

 private:
  /// Checks the order of arrival and advances the expected sequence.
  [[nodiscard]] std::optional<Rejection> judge_sequence(const Frame& frame);
  /// Checks the pixels of a complete, new frame of the right size.
  [[nodiscard]] std::optional<Rejection> judge_pixels(const Frame& frame);

  IntegrityOptions options_;
  std::optional<std::uint64_t> last_sequence_;
  std::deque<cv::Mat1w> recent_;  ///< pixels of the last complete frames, the newest first
  std::uint64_t accepted_ = 0;
  std::uint64_t lost_ = 0;
  NumberingFaults numbering_;
  std::map<Rejection, std::uint64_t> rejected_;
};

}  // namespace todbench
