// SPDX-License-Identifier: GPL-3.0-or-later
// effective_contrast: inside minus surround of the large triangles; contrast_of_small_triangles: their sums.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "acquisition/base/median.h"
#include "tod/plate/plate_outlines.h"
#include "tod/registration/registration.h"

namespace todbench {
namespace {

constexpr double ring_begin_px = 1.5;

/// Distance to the edge of a convex polygon, > 0 inside.
double depth(const Polygon& polygon, cv::Point2d at) {
  double inside = std::numeric_limits<double>::infinity();
  double nearest = inside;
  const double orientation = (polygon[1] - polygon[0]).cross(polygon[2] - polygon[1]) > 0 ? 1 : -1;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const cv::Point2d edge = polygon[(i + 1) % polygon.size()] - polygon[i];
    const cv::Point2d to = at - polygon[i];
    inside = std::min(inside, orientation * edge.cross(to) / cv::norm(edge));
    const double t = std::clamp(to.dot(edge) / edge.dot(edge), 0.0, 1.0);
    nearest = std::min(nearest, cv::norm(to - t * edge));
  }
  return inside >= 0 ? inside : -nearest;
}

/// Standard error of a median of white noise with the spread of the median absolute deviation: sqrt(pi / 2) sigma /
/// sqrt(n).
double median_error(const std::vector<double>& values, double sigma) {
  return std::sqrt(std::numbers::pi / 2 / static_cast<double>(values.size())) * sigma;
}

double spread(std::vector<double> values) {
  const double middle = median(values);
  for (double& v : values) v = std::abs(v - middle);
  return 1.4826 * median(std::move(values));
}

/// Mean of the values within `reach` of their median.
double mean_near_median(const std::vector<double>& values, double reach) {
  const double middle = median(values);
  double sum = 0, n = 0;
  for (const double v : values) {
    if (std::abs(v - middle) > reach) continue;
    sum += v;
    n += 1;
  }
  return sum / n;
}

/// Smallest rectangle with the outline and `reach` pixels round it, as first and last pixels.
struct PixelBox {
  int left = 0, top = 0, right = 0, bottom = 0;
};

PixelBox box_round(const Polygon& outline, double reach) {
  cv::Point2d low = outline[0], high = outline[0];
  for (const cv::Point2d& p : outline) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  return {static_cast<int>(std::floor(low.x - reach)), static_cast<int>(std::floor(low.y - reach)),
          static_cast<int>(std::ceil(high.x + reach)), static_cast<int>(std::ceil(high.y + reach))};
}

std::vector<Polygon> outlines_of(const TargetPlate& mounted_plate, const Registration& registration) {
  std::vector<Polygon> outlines;
  for (const PlateTriangle& t : mounted_plate.triangles)
    outlines.push_back(outline_in_picture(registration.plate_to_pixel, t, t.apex));
  return outlines;
}

struct Samples {
  std::vector<double> inside, ring;
};

/// Pixels of the inside and of the ring round triangle `which`; pixels near other triangles belong to neither.
Samples samples(const cv::Mat1d& picture, const std::vector<Polygon>& outlines, std::size_t which, double margin) {
  const Polygon& own = outlines[which];
  const double reach = ring_begin_px + contrast_ring_width_px;
  const PixelBox box = box_round(own, reach);
  Samples result;
  double deepest = -std::numeric_limits<double>::infinity();
  double deepest_value = 0;
  const int top = std::max(0, box.top), bottom = std::min(picture.rows - 1, box.bottom);
  const int left = std::max(0, box.left), right = std::min(picture.cols - 1, box.right);
  for (int y = top; y <= bottom; ++y) {
    for (int x = left; x <= right; ++x) {
      const double d = depth(own, cv::Point2d(x, y));
      if (d > deepest) {
        deepest = d;
        deepest_value = picture(y, x);
      }
      if (d >= margin) result.inside.push_back(picture(y, x));
      if (d > -ring_begin_px || d < -reach) continue;
      bool free = true;
      for (std::size_t k = 0; free && k < outlines.size(); ++k) {
        free = k == which || depth(outlines[k], cv::Point2d(x, y)) < -ring_begin_px;
      }
      if (free) result.ring.push_back(picture(y, x));
    }
  }
  if (result.inside.empty()) result.inside.push_back(deepest_value);
  return result;
}

/// Sum over a triangle and `margin` px round it, minus its surround: sum and area for the unit contrast. The surround
/// is the mean of a ring; empty: a pixel of both leaves the picture, or the ring touches another triangle.
std::optional<double> summed_contrast(const cv::Mat1d& picture, const std::vector<Polygon>& outlines,
                                      std::size_t which) {
  constexpr double margin_px = 2, reach_px = margin_px + contrast_ring_width_px;
  const PixelBox box = box_round(outlines[which], reach_px);
  if (box.left < 0 || box.top < 0 || box.right >= picture.cols || box.bottom >= picture.rows) return std::nullopt;
  double sum = 0, ring = 0, pixels = 0, ring_pixels = 0;
  for (int y = box.top; y <= box.bottom; ++y) {
    for (int x = box.left; x <= box.right; ++x) {
      const cv::Point2d at(x, y);
      const double d = depth(outlines[which], at);
      if (d < -reach_px) continue;
      for (std::size_t k = 0; k < outlines.size(); ++k)
        if (k != which && depth(outlines[k], at) > -margin_px) return std::nullopt;
      (d >= -margin_px ? sum : ring) += picture(y, x);
      (d >= -margin_px ? pixels : ring_pixels) += 1;
    }
  }
  return sum - pixels * ring / ring_pixels;
}

}  // namespace

std::optional<double> contrast_of_small_triangles(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                                  const Registration& registration, double below_px) {
  constexpr double least_px = 2;
  const std::vector<Polygon> outlines = outlines_of(mounted_plate, registration);
  double sum = 0, area_px = 0;
  for (std::size_t k = 0; k < outlines.size(); ++k) {
    const PlateTriangle& t = mounted_plate.triangles[k];
    const double size_px = t.size_mm * registration.scale_at(t.position_mm);
    if (size_px < least_px || size_px >= below_px) continue;
    const auto one = summed_contrast(picture, outlines, k);
    if (!one) continue;
    sum += *one;
    area_px += size_px * size_px;
  }
  return area_px > 0 ? std::optional(sum / area_px) : std::nullopt;
}

Result<EffectiveContrast> effective_contrast(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                             const Registration& registration, double min_size_px,
                                             LevelEstimate level) {
  const std::string doing = "measuring the contrast of plate \"" + mounted_plate.name + "\": ";
  if (picture.empty() || !cv::checkRange(picture)) {
    return fail(ErrorCode::invalid_input, doing + "the picture is empty or contains a value that is not finite");
  }
  const std::vector<Polygon> outlines = outlines_of(mounted_plate, registration);
  std::vector<ReferenceTriangle> references;
  double largest = 0;
  for (std::size_t k = 0; k < outlines.size(); ++k) {
    const PlateTriangle& t = mounted_plate.triangles[k];
    const double size = t.size_mm * registration.scale_at(t.position_mm);
    largest = std::max(largest, size);
    if (size < min_size_px) continue;
    for (const cv::Point2d& p : outlines[k]) {
      if (p.x >= 0 && p.y >= 0 && p.x <= picture.cols - 1 && p.y <= picture.rows - 1) continue;
      return fail(ErrorCode::calibration, doing + t.name + " is not entirely inside the picture");
    }
    const double margin = std::min(contrast_inner_share * triangle_centroid_to_base * size, contrast_inner_most_px);
    const Samples s = samples(picture, outlines, k, margin);
    if (s.ring.empty()) return fail(ErrorCode::calibration, doing + t.name + " has no free surround in the picture");
    const double noise = spread(s.ring);
    const double between_medians = median(s.inside) - median(s.ring);
    const double reach = std::max(8 * noise, 0.5 * std::abs(between_medians));
    const double contrast = level == LevelEstimate::median
                                ? between_medians
                                : mean_near_median(s.inside, reach) - mean_near_median(s.ring, reach);
    references.push_back({.value = contrast,
                          .place_px = to_pixel(registration.plate_to_pixel, t.position_mm),
                          .size_px = size,
                          .noise = std::hypot(median_error(s.inside, noise), median_error(s.ring, noise))});
  }
  if (references.empty()) {
    return fail(ErrorCode::invalid_input, doing + "no triangle is at least " + fixed(min_size_px, 1) +
                                              " px, the largest is " + fixed(largest, 1) + " px");
  }
  EffectiveContrast result;
  result.triangles = static_cast<int>(references.size());
  const double n = static_cast<double>(references.size());
  for (const ReferenceTriangle& r : references) result.value += r.value / n;
  double squares = 0;
  for (const ReferenceTriangle& r : references) squares += (r.value - result.value) * (r.value - result.value);
  result.standard_error = n > 1 ? std::sqrt(squares / (n - 1) / n) : references[0].noise;
  result.references = std::move(references);
  return result;
}

}  // namespace todbench
