#include "tod/measures/medians.h"

#include <algorithm>
#include <vector>

namespace todbench {

double median_of(const cv::Mat1d& picture) {
  std::vector<double> values(picture.begin(), picture.end());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

double median_deviation_of(const cv::Mat1d& picture) {
  return median_of(cv::abs(picture - median_of(picture)));
}

}  // namespace todbench
