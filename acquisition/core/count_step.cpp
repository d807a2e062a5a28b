// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/count_step.h"

#include <cstdlib>
#include <numeric>

namespace todbench {

void CountStep::add(const cv::Mat1w& counts) {
  if (step_ == 1) return;
  if (last_.size() == counts.size()) {
    for (int row = 0; row < counts.rows && step_ != 1; ++row) {
      for (int column = 0; column < counts.cols && step_ != 1; ++column)
        step_ = std::gcd(step_, std::abs(int{counts(row, column)} - int{last_(row, column)}));
    }
  }
  // A copy, because a frame may hold one of the few buffers of its camera.
  counts.copyTo(last_);
}

}  // namespace todbench
