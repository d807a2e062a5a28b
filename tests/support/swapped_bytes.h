// SPDX-License-Identifier: GPL-3.0-or-later
// A picture in the wrong order of bytes.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace todbench {

/// The picture with the two bytes of every pixel exchanged.
inline cv::Mat1w with_swapped_bytes(const cv::Mat1w& counts) {
  cv::Mat1w out = counts.clone();
  for (auto& count : out) count = static_cast<std::uint16_t>(count << 8 | count >> 8);
  return out;
}

}  // namespace todbench
