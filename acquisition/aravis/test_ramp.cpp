// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/aravis/test_ramp.h"

#include <cstdint>

namespace todbench {
namespace {

constexpr int least_columns = 16;
/// Step of a ramp: 1 count per pixel, or full scale over the width (65535 / 640 columns).
constexpr int largest_step = 128;
constexpr double agreeing_share = 0.95;

std::uint16_t swapped(std::uint16_t value) {
  return static_cast<std::uint16_t>(value << 8 | value >> 8);
}

template <typename Order>
bool rises(const cv::Mat1w& counts, Order order) {
  std::uint64_t agreeing = 0, all = 0;
  for (int row = 0; row < counts.rows; ++row) {
    const std::uint16_t* pixels = counts.ptr<std::uint16_t>(row);
    const int step = order(pixels[1]) - order(pixels[0]);
    if (step < 1 || step > largest_step) {
      all += static_cast<std::uint64_t>(counts.cols);
      continue;
    }
    for (int x = 1; x < counts.cols; ++x, ++all) {
      const int difference = order(pixels[x]) - order(pixels[x - 1]);
      // Steps of a ramp over the full scale alternate between two neighbouring integers.
      if (difference >= step - 1 && difference <= step + 1 && difference > 0) ++agreeing;
    }
  }
  return all > 0 && static_cast<double>(agreeing) >= agreeing_share * static_cast<double>(all);
}

}  // namespace

RampVerdict judge_test_ramp(const cv::Mat1w& counts) {
  if (counts.cols < least_columns || counts.rows < 1) return RampVerdict::no_ramp;
  if (rises(counts, [](std::uint16_t value) { return static_cast<int>(value); })) return RampVerdict::in_order;
  if (rises(counts, [](std::uint16_t value) { return static_cast<int>(swapped(value)); })) return RampVerdict::swapped;
  return RampVerdict::no_ramp;
}

}  // namespace todbench
