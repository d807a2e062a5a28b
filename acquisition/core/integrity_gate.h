// Which frames may be measured. Everything else is counted by reason and never used.
#pragma once

#include <cstdint>
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
  repeated,                  ///< a sequence number seen before
  out_of_order,              ///< a sequence number below the last one
  frozen,                    ///< bit-identical to the frame before it (shutter, stuck transfer)
  saturated,                 ///< more than the allowed share of pixels at zero or full scale
  nonuniformity_correction,  ///< during or just after a correction
};

[[nodiscard]] std::string_view to_string(Rejection reason);

struct IntegrityOptions {
  int width = 0, height = 0;          ///< expected geometry; 0: not checked
  double max_saturated_share = 0.01;  ///< of all pixels
  bool reject_frozen = true;  ///< false only for a simulated sensor without noise, whose frames are equal by right
};

/// Looks at every frame in order of arrival. One thread at a time.
class IntegrityGate {
 public:
  explicit IntegrityGate(IntegrityOptions options);
  /// Nothing when the frame may be measured; otherwise the first reason that applies. Counts either way.
  [[nodiscard]] std::optional<Rejection> judge(const Frame& frame);
  /// Counts a frame as rejected for a reason that only the caller knows (time since a correction).
  void reject(Rejection reason);

  [[nodiscard]] std::uint64_t accepted() const { return accepted_; }
  [[nodiscard]] std::uint64_t rejected() const;
  [[nodiscard]] const std::map<Rejection, std::uint64_t>& rejected_by_reason() const { return rejected_; }
  /// Exposures that never arrived: gaps in the sequence, summed.
  [[nodiscard]] std::uint64_t lost() const { return lost_; }

 private:
  IntegrityOptions options_;
  std::optional<std::uint64_t> last_sequence_;
  cv::Mat1w last_counts_;
  std::uint64_t accepted_ = 0;
  std::uint64_t lost_ = 0;
  std::map<Rejection, std::uint64_t> rejected_;
};

}  // namespace todbench
