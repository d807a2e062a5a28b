// SPDX-License-Identifier: GPL-3.0-or-later
// Determines the byte order of 16-bit counts from the picture.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>

namespace todbench {

/// Verdict on the byte order.
enum class ByteOrderVerdict {
  as_stated,  ///< neighbouring pixels differ less than with their bytes swapped
  swapped,    ///< neighbouring pixels differ less with their bytes swapped
  undecided,  ///< flat, noise over the whole range, or only one byte varies
};

[[nodiscard]] std::string_view to_string(ByteOrderVerdict verdict);

/// Result of the test. V(x) is the mean absolute difference of horizontal neighbours in a picture x. Counts of a
/// thermal picture change little from pixel to pixel: their high byte is smooth, their low byte is not. Swapping makes
/// the low byte the high byte, so V increases. With a random low byte, V increases to 256 * 256 / 3 = 21845 counts.
struct ByteOrderEvidence {
  /// ln(V(x) / V(x with swapped bytes)); antisymmetric under swapping. Negative: the order is right. Zero if the
  /// verdict is undecided because a picture is flat.
  double log_ratio = 0;
  ByteOrderVerdict verdict = ByteOrderVerdict::undecided;
  std::uint16_t bits = 0;  ///< bits that are set in at least one examined pixel
};

/// Options of byte_order_evidence().
struct ByteOrderOptions {
  /// Limit of |log_ratio| below which the order is undecided. Temporal or spatial noise of 16-bit counts with standard
  /// deviation sigma has V = 2 sigma / sqrt(pi), so the default allows for noise up to sigma = 7000 counts.
  double least_log_ratio = 1;
};

/// Tests the byte order of a picture in up to 64 evenly spaced rows. A picture whose low byte is zero everywhere (8
/// bits shifted up) or whose high byte is zero everywhere (8 bits) is undecided, because both orders are equally
/// smooth.
[[nodiscard]] ByteOrderEvidence byte_order_evidence(const cv::Mat1w& counts, const ByteOrderOptions& options);

/// Byte order of all frames of a recording. One thread at a time.
class ByteOrderWatch {
 public:
  /// Adds a frame. `significant_bits`: number of used bits of a count; counts of 8 or fewer bits have no byte order.
  void see(const cv::Mat1w& counts, int significant_bits);
  /// Returns the byte order of the frames; `as_stated` for counts of one byte, and before the first frame.
  [[nodiscard]] ByteOrderVerdict verdict() const;
  /// Returns a sentence if one byte is zero in all examined pixels, because the byte order is then unknown; otherwise
  /// empty.
  [[nodiscard]] std::string note() const;

 private:
  std::uint16_t bits_ = 0;
  bool two_bytes_ = false, as_stated_ = false, swapped_ = false;
};

}  // namespace todbench
