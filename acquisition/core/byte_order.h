// Whether the two bytes of the counts of a picture are in the right order, told from the picture itself.
#pragma once

#include <opencv2/core.hpp>
#include <string_view>

namespace todbench {

enum class ByteOrderVerdict {
  as_stated,  ///< neighbouring pixels are more alike than with their bytes swapped
  swapped,    ///< the other way round
  undecided,  ///< flat, noise over the whole range, or only one byte carries anything
};

[[nodiscard]] std::string_view to_string(ByteOrderVerdict verdict);

/// What was seen. V(x) is the mean absolute difference of horizontal neighbours in a picture x. Counts of a thermal
/// picture change by little from pixel to pixel: their high byte is smooth and their low byte is not. Swapped, the low
/// byte becomes the high one and V grows; for a low byte that is as good as random to 256 * 256 / 3 = 21845 counts.
struct ByteOrderEvidence {
  /// ln(V(x) / V(x with swapped bytes)); antisymmetric under swapping. Below zero: the order is right. Zero when
  /// `verdict` is undecided because a picture is flat.
  double log_ratio = 0;
  ByteOrderVerdict verdict = ByteOrderVerdict::undecided;
};

struct ByteOrderOptions {
  /// |log_ratio| below this is undecided. Temporal or spatial noise of 16-bit counts with a standard deviation of
  /// sigma has V = 2 sigma / sqrt(pi), so this allows for noise up to sigma = 7000 counts.
  double least_log_ratio = 1;
};

/// Looks at up to 64 rows, evenly spread. A picture whose low byte is zero everywhere (8 bits shifted up) or
/// whose high byte is zero everywhere (8 bits) is undecided: it reads the same story in both orders.
[[nodiscard]] ByteOrderEvidence byte_order_evidence(const cv::Mat1w& counts, const ByteOrderOptions& options);

}  // namespace todbench
