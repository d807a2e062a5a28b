// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/camera_measures/pixel_measure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "acquisition/base/median.h"
#include "acquisition/base/try.h"
#include "tod/measures/shading.h"
#include "tod/plate/plate_outlines.h"

namespace todbench {
namespace {

constexpr int clear_of_outline_px = 2;

/// 255 inside the triangles, in the pixels of the frame.
cv::Mat1b triangle_mask(const TargetPlate& plate, const Registration& where, cv::Size frame) {
  cv::Mat1b mask(frame, std::uint8_t{0});
  constexpr int bits = 8;
  for (const PlateTriangle& triangle : plate.triangles) {
    std::vector<cv::Point> corners;
    for (const cv::Point2d& p : outline_in_picture(where.plate_to_pixel, triangle, triangle.apex))
      corners.emplace_back(cv::saturate_cast<int>(p.x * (1 << bits)), cv::saturate_cast<int>(p.y * (1 << bits)));
    cv::fillConvexPoly(mask, corners, cv::Scalar(255), cv::LINE_8, bits);
  }
  return mask;
}

double median_where(const cv::Mat1d& picture, const cv::Mat1b& mask) {
  std::vector<double> values;
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x)
      if (mask(y, x) != 0) values.push_back(picture(y, x));
  return values.empty() ? 0 : median(std::move(values));
}

int pixel_edge(double fraction, int side) {
  return std::clamp(static_cast<int>(std::ceil(fraction * side - 0.5)), 0, side);
}

}  // namespace

cv::Rect ZoneArea::pixels(cv::Size frame) const {
  const cv::Point first(pixel_edge(left, frame.width), pixel_edge(top, frame.height));
  const cv::Point end(pixel_edge(right, frame.width), pixel_edge(bottom, frame.height));
  return {first, end};
}

Result<PixelMeasure> measure_pixels(std::span<const cv::Mat1f> frames, cv::Size frame, const cv::Rect& field,
                                    PixelScene scene, const PixelOptions& options) {
  if (frames.empty()) return fail(ErrorCode::invalid_input, "the test for defective pixels needs frames");
  cv::Mat1d mean = cv::Mat1d::zeros(frames[0].size());
  for (const cv::Mat1f& one : frames) cv::add(mean, one, mean, cv::noArray(), CV_64F);
  mean /= static_cast<double>(frames.size());
  // An extreme pixel would bend the surface: it is replaced by the median of its neighbours.
  cv::Mat1f smooth;
  mean.convertTo(smooth, CV_32F);
  cv::medianBlur(smooth.clone(), smooth, 5);
  cv::Mat1d robust;
  smooth.convertTo(robust, CV_64F);
  scene.shading = shading_of(robust).surface;
  TODBENCH_TRY(auto defects, pixel_defects(frames, scene, options.rules));
  PixelMeasure measure{.frame = frame, .field = field, .defects = std::move(defects), .zones = {}};
  std::vector<ZoneArea> zones{{.name = "whole"}};
  zones.insert(zones.end(), options.zones.begin(), options.zones.end());
  for (const ZoneArea& zone : zones)
    measure.zones.push_back({zone, count_zone(measure.defects, field, zone.pixels(frame))});
  return measure;
}

cv::Mat1d responsivity_in_triangles(std::span<const ContrastPicture> pictures, const TargetPlate& mounted_plate,
                                    const Registration& where, const cv::Rect& field, const cv::Rect& plate) {
  const cv::Size frame = pictures[0].kelvin.size();
  const cv::Mat1b inside = triangle_mask(mounted_plate, where, frame);
  const cv::Mat1b reach = cv::Mat1b::ones(2 * clear_of_outline_px + 1, 2 * clear_of_outline_px + 1);
  cv::Mat1b middle, near;
  cv::erode(inside, middle, reach, {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::dilate(inside, near, reach);
  const cv::Mat1b surround = near(plate) == 0;
  double mean_k = 0, squares = 0;
  for (const ContrastPicture& picture : pictures) mean_k += picture.delta_t_k / static_cast<double>(pictures.size());
  cv::Mat1d slope = cv::Mat1d::zeros(frame);
  for (const ContrastPicture& picture : pictures) {
    const double step = picture.delta_t_k - mean_k;
    slope += step * (picture.kelvin - median_where(picture.kelvin(plate), surround));
    squares += step * step;
  }
  slope /= squares;
  slope.setTo(std::numeric_limits<double>::quiet_NaN(), middle == 0);
  return slope(field).clone();
}

}  // namespace todbench
