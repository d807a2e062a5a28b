// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/camera_measures/plate_offset.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "hvs/shape/polygon_coverage.h"

namespace todbench {
namespace {

constexpr double least_match = 0.5;  // of the correlation with the plate
constexpr int template_margin = 3;

}  // namespace

cv::Rect2d box_of(const Polygon& polygon) {
  cv::Point2d low = polygon.front(), high = polygon.front();
  for (const cv::Point2d& p : polygon) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  return {low, high};
}

Result<cv::Point2d> plate_offset(const cv::Mat1d& picture, const std::vector<Polygon>& outlines,
                                 const std::string& plate) {
  cv::Rect2d box = box_of(outlines.front());
  for (const Polygon& outline : outlines) box |= box_of(outline);
  const cv::Point origin(static_cast<int>(std::floor(box.x)) - template_margin,
                         static_cast<int>(std::floor(box.y)) - template_margin);
  const cv::Size size(static_cast<int>(std::ceil(box.width)) + 2 * template_margin + 1,
                      static_cast<int>(std::ceil(box.height)) + 2 * template_margin + 1);
  if (size.width > picture.cols || size.height > picture.rows)
    return fail(ErrorCode::calibration, "plate '" + plate + "' is larger than the picture");
  cv::Mat1d expected(size, 0.0);
  for (const Polygon& outline : outlines) {
    Polygon cells = outline;  // pixel_coverage() has corners of pixels at whole numbers, the picture has centres
    for (cv::Point2d& p : cells) p += cv::Point2d(0.5 - origin.x, 0.5 - origin.y);
    expected += pixel_coverage(cells, size);
  }
  cv::Mat1f from, to, match;
  cv::Mat1d(picture - cv::mean(picture)[0]).convertTo(from, CV_32F);
  expected.convertTo(to, CV_32F);
  cv::matchTemplate(from, to, match, cv::TM_CCOEFF_NORMED);
  match = cv::abs(match);
  double best = 0;
  cv::Point at;
  cv::minMaxLoc(match, nullptr, &best, nullptr, &at);
  if (!(best >= least_match))
    return fail(ErrorCode::calibration, "the rectangles of plate '" + plate + "' were not found in the picture");
  return cv::Point2d(at - origin);
}

}  // namespace todbench
