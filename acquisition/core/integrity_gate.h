// Which frames may be measured. Everything else is counted by reason and never used.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "acquisition/core/frame.h"

namespace todbench {

/// Why a frame was not used.
enum class Rejection {
  incomplete,                ///< the transport says so
  wrong_size,                ///< not the geometry of the source
  repeated,                  ///< a sequence number seen before, or the pixels of one of the frames before the last
  out_of_order,              ///< a sequence number below the last one
  gapped,                    ///< exposures are missing just before it
  frozen,                    ///< bit-identical to the frame before it (shutter, stuck transfer)
  saturated,                 ///< more than the allowed share of pixels at zero or full scale
  byte_swapped,              ///< the picture says that its bytes are in the other order
  nonuniformity_correction,  ///< during or just after a correction
};
inline constexpr Rejection all_rejections[] = {
    Rejection::incomplete,   Rejection::wrong_size,   Rejection::repeated,
    Rejection::out_of_order, Rejection::gapped,       Rejection::frozen,
    Rejection::saturated,    Rejection::byte_swapped, Rejection::nonuniformity_correction};

[[nodiscard]] std::string_view to_string(Rejection reason);

/// What was wrong with the numbers of the frames themselves.
struct NumberingFaults {
  std::uint64_t restarts = 0;        ///< Numbering::restarted
  std::uint64_t silent_gaps = 0;     ///< Numbering::timed
  std::uint64_t estimated_lost = 0;  ///< exposures missing at both, of those in lost()
  bool operator==(const NumberingFaults&) const = default;
};

/// One sentence about them; empty where there were none.
[[nodiscard]] std::string describe(const NumberingFaults& faults);

struct IntegrityOptions {
  int width = 0, height = 0;          ///< expected geometry; 0: not checked
  double max_saturated_share = 0.01;  ///< of all pixels
  /// False only for a simulated sensor without noise, whose frames are equal by right and tell nothing of corrections.
  bool reject_frozen = true;
};

/// Looks at every frame in order of arrival. One thread at a time.
class IntegrityGate {
 public:
  explicit IntegrityGate(IntegrityOptions options);
  /// Nothing when the frame may be measured; otherwise the first reason that applies. Counts either way.
  [[nodiscard]] std::optional<Rejection> judge(const Frame& frame);
  /// Takes back the acceptance of the last frame for a reason that only the caller knows (time since a correction).
  void reject_accepted(Rejection reason);
  /// Moves a frame that judge() has just rejected for `from` to another reason, which only the caller knows.
  void recount(Rejection from, Rejection to);

  [[nodiscard]] std::uint64_t accepted() const { return accepted_; }
  [[nodiscard]] std::uint64_t rejected() const;
  [[nodiscard]] const std::map<Rejection, std::uint64_t>& rejected_by_reason() const { return rejected_; }
  /// Exposures that never arrived: gaps in the sequence, summed.
  [[nodiscard]] std::uint64_t lost() const { return lost_; }
  /// How often the numbers of the camera did not fit the time that passed, and what of lost() is estimated from time.
  [[nodiscard]] const NumberingFaults& numbering() const { return numbering_; }

 private:
  /// What is wrong with the order of arrival; moves the expected sequence on.
  [[nodiscard]] std::optional<Rejection> judge_sequence(const Frame& frame);
  /// What is wrong with a frame that is whole, new and of the right size.
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
