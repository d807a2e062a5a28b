// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures behind display and eye, for criteria without templates.
#pragma once

#include <opencv2/core.hpp>

#include "hvs/observer/template_observer.h"

namespace todbench {

/// Pictures behind display and H, as means over the area of each displayed sample. The noise of the eye in such a mean
/// is independent of the others, of standard deviation 1 over the side of a sample in degrees. Immutable, thread-safe.
class SeenPicture {
 public:
  /// Square pictures of `side` samples. Precondition: an eye with a display.
  SeenPicture(const TemplateObserverSpec& spec, int side);
  /// Returns a picture behind display and eye. Its background, the mean of its outermost samples, continues beyond its
  /// border.
  [[nodiscard]] cv::Mat1f of(const cv::Mat1f& picture) const;

 private:
  TemplateObserverSpec spec_;
  int period_;        ///< of the transform, at least twice the side
  cv::Mat1f factor_;  ///< of each frequency of the transform
};

}  // namespace todbench
