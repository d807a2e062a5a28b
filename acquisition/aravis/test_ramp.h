// SPDX-License-Identifier: GPL-3.0-or-later
// Checks a camera's byte order and bit alignment with its test ramp.
#pragma once

#include <opencv2/core.hpp>

namespace todbench {

/// Verdict on a test ramp.
enum class RampVerdict {
  in_order,  ///< counts rise along the rows
  swapped,   ///< counts rise along the rows if the bytes of every pixel are exchanged
  no_ramp,   ///< neither: another picture, or too few pixels
};

/// Judges a test ramp: nearly everywhere a pixel exceeds its left neighbour by the same small step; where the ramp
/// restarts, the count falls back. Needs at least 16 columns; all rows are examined, and 95 % of the neighbours must
/// agree.
[[nodiscard]] RampVerdict judge_test_ramp(const cv::Mat1w& counts);

}  // namespace todbench
