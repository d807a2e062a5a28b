// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures after display and eye, for criteria without templates.
#pragma once

#include <opencv2/core.hpp>

#include "hvs/observer/template_observer.h"

namespace todbench {

/// Filters pictures with the display and with the filter H of the eye (EyeFilter). Each value of the result is the mean
/// over the area of a displayed sample. The noise of the eye is independent between these means and has a standard
/// deviation of 1 / (side of a sample in degrees). Immutable, thread-safe.
class SeenPicture {
 public:
  /// Prepares the filter for square pictures of `side` samples. Precondition: an eye with a display.
  SeenPicture(const TemplateObserverSpec& spec, int side);
  /// Returns a picture after display and eye. Outside the border, the picture is continued with the mean of its
  /// outermost samples.
  [[nodiscard]] cv::Mat1f of(const cv::Mat1f& picture) const;

 private:
  TemplateObserverSpec spec_;
  int period_;        ///< period of the transform, at least twice the side
  cv::Mat1f factor_;  ///< factor of each frequency of the transform
};

}  // namespace todbench
