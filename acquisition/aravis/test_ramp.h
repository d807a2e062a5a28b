// Whether a camera's bytes and bits arrive as it says, told from its test ramp.
#pragma once

#include <opencv2/core.hpp>

namespace todbench {

enum class RampVerdict {
  in_order,  ///< counts rise along the rows
  swapped,   ///< counts rise along the rows when both bytes of every pixel change places
  no_ramp,   ///< neither: another picture, or too few pixels
};

/// A ramp has the count of its left neighbour plus the same small step nearly everywhere; where it starts anew it falls
/// back. Asks for at least 16 columns; all rows are looked at, and 95 % of the neighbours must agree.
[[nodiscard]] RampVerdict judge_test_ramp(const cv::Mat1w& counts);

}  // namespace todbench
