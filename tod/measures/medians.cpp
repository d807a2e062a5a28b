// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/medians.h"

#include "acquisition/base/median.h"

namespace todbench {

double median_of(const cv::Mat1d& picture) {
  return median({picture.begin(), picture.end()});
}

double median_deviation_of(const cv::Mat1d& picture) {
  return median_of(cv::abs(picture - median_of(picture)));
}

}  // namespace todbench
