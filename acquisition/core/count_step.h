// SPDX-License-Identifier: GPL-3.0-or-later
// Step of the counts of a camera, measured from its frames.
#pragma once

#include <opencv2/core.hpp>

namespace todbench {

/// Measures the greatest common divisor of the changes of pixels between successive frames. The divisor is 1 for most
/// cameras. It is larger if a camera or a converter fills the low bits of the counts with zeros.
class CountStep {
 public:
  /// Compares a frame with the previous frame. The first frame, and a frame of a different size, are only stored.
  void add(const cv::Mat1w& counts);
  /// Returns the step in counts; 0 if no pixel has changed.
  [[nodiscard]] int step() const { return step_; }
  /// Returns the factor from steps to counts: 1 if no pixel has changed.
  [[nodiscard]] int counts_per_step() const { return step_ > 0 ? step_ : 1; }

 private:
  cv::Mat1w last_;
  int step_ = 0;
};

}  // namespace todbench
