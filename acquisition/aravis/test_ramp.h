// SPDX-License-Identifier: GPL-3.0-or-later
// Checks a camera's byte order and bit alignment with its test ramp.
#pragma once

#include <opencv2/core.hpp>

namespace todbench {

/// Verdict on a test ramp.
enum class RampVerdict {
  in_order,  ///< counts rise along the rows
  swapped,   ///< counts rise along the rows if the bytes of every pixel are exchanged
  no_ramp,   ///< neither: the picture is no ramp, or has too few pixels
};

/// Judges a test ramp. In a ramp nearly every pixel exceeds its left neighbour by the same small step, and the count
/// falls back where the ramp restarts. All rows are examined; 95 % of the neighbours must agree. Needs at least 16
/// columns.
[[nodiscard]] RampVerdict judge_test_ramp(const cv::Mat1w& counts);

}  // namespace todbench
