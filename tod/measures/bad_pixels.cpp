// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/bad_pixels.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <vector>

#include "tod/measures/medians.h"

namespace todbench {
namespace {

/// Number of pixels connected with `seed`, also diagonally; they are removed from `left`.
int take_cluster(cv::Mat1b& left, cv::Point seed) {
  std::vector<cv::Point> open{seed};
  left(seed) = 0;
  int size = 0;
  while (!open.empty()) {
    const cv::Point at = open.back();
    open.pop_back();
    ++size;
    for (int y = std::max(0, at.y - 1); y <= std::min(left.rows - 1, at.y + 1); ++y) {
      for (int x = std::max(0, at.x - 1); x <= std::min(left.cols - 1, at.x + 1); ++x) {
        if (left(y, x) == 0) continue;
        left(y, x) = 0;
        open.emplace_back(x, y);
      }
    }
  }
  return size;
}

void count_clusters(BadPixels& found) {
  cv::Mat1b left = found.bad.clone();
  for (int y = 0; y < left.rows; ++y) {
    for (int x = 0; x < left.cols; ++x) {
      if (left(y, x) == 0) continue;
      const int size = take_cluster(left, {x, y});
      found.largest_cluster = std::max(found.largest_cluster, size);
      if (size >= 2) ++found.clusters;
    }
  }
}

}  // namespace

bool responds_badly(double relative_responsivity, const BadPixelRules& rules) {
  return relative_responsivity < 1 - rules.dead_responsivity ||
         (rules.strong_responsivity && relative_responsivity > 1 + rules.dead_responsivity);
}

Result<BadPixels> bad_pixels(const PixelProperties& pixels, const BadPixelRules& rules) {
  cv::Size size;
  for (const cv::Mat1d* picture : {&pixels.responsivity, &pixels.offset, &pixels.noise_sd}) {
    if (picture->empty()) continue;
    if (!size.empty() && picture->size() != size)
      return fail(ErrorCode::invalid_input, "the pictures of the properties of the pixels have different sizes");
    if (!cv::checkRange(*picture)) return fail(ErrorCode::invalid_input, "a pixel has a value that is not finite");
    size = picture->size();
  }
  if (size.empty()) return fail(ErrorCode::invalid_input, "no property of the pixels is given");
  BadPixels found;
  found.dead = cv::Mat1b::zeros(size), found.noisy = cv::Mat1b::zeros(size), found.offset = cv::Mat1b::zeros(size);
  if (!pixels.responsivity.empty()) {
    const double median = median_of(pixels.responsivity);
    if (median == 0) return fail(ErrorCode::invalid_input, "half of the pixels do not respond at all");
    std::ranges::transform(pixels.responsivity, found.dead.begin(),
                           [&](double value) -> uchar { return responds_badly(value / median, rules) ? 255 : 0; });
  }
  if (!pixels.noise_sd.empty()) {
    const double median = median_of(pixels.noise_sd);
    if (!(median > 0)) return fail(ErrorCode::invalid_input, "half of the pixels have no noise");
    found.noisy = pixels.noise_sd > rules.noisy * median;
  }
  if (!pixels.offset.empty()) {
    // 1.4826: the standard deviation of normal values over their median deviation.
    const double deviation = 1.4826 * median_deviation_of(pixels.offset);
    found.offset = cv::abs(pixels.offset - median_of(pixels.offset)) > rules.offset * deviation;
  }
  found.bad = found.dead | found.noisy | found.offset;
  found.count = cv::countNonZero(found.bad);
  found.operability_percent = 100 * (1 - found.count / static_cast<double>(found.bad.total()));
  count_clusters(found);
  return found;
}

}  // namespace todbench
