// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/saturation_watch.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "tod/measures/medians.h"

namespace todbench {
namespace {

constexpr int pixels_of_an_end = 3;       ///< fewer may be stuck at a count that other pixels do not reach
constexpr double noise_range_counts = 3;  ///< a pixel with less noise may stay unchanged by chance
constexpr double blur_px = 3;             ///< beyond this distance a triangle has no effect
constexpr double most_defective = 0.01;   ///< of the pixels: a larger share belongs to the scene

/// Median range of the pixels that changed.
double range_of_moving(const AveragedPicture& picture) {
  std::vector<int> ranges;
  for (int row = 0; row < picture.lowest.rows; ++row) {
    for (int column = 0; column < picture.lowest.cols; ++column) {
      const int range = picture.highest(row, column) - picture.lowest(row, column);
      if (range > 0) ranges.push_back(range);
    }
  }
  if (ranges.empty()) return 0;
  const auto middle = ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() / 2);
  std::nth_element(ranges.begin(), middle, ranges.end());
  return *middle;
}

/// 1 where a triangle may be visible.
cv::Mat1b seen_triangles(cv::Size size, const TargetPlate& plate, const Registration& registration) {
  cv::Mat1b seen(size, std::uint8_t{0});
  for (const PlateTriangle& triangle : plate.triangles) {
    const cv::Point2d centre = registration.pixel(triangle.position_mm);
    // A corner is 2 / 27^(1/4) of the size from the centroid.
    const double highest = std::max(1.0, 1 / registration.pixel_aspect);  // pixels along y for one along x
    const double reach = 0.878 * triangle.size_mm * registration.scale_at(triangle.position_mm) * highest + blur_px;
    const int top = std::max(0, static_cast<int>(std::floor(centre.y - reach)));
    const int bottom = std::min(size.height - 1, static_cast<int>(std::ceil(centre.y + reach)));
    const int left = std::max(0, static_cast<int>(std::floor(centre.x - reach)));
    const int right = std::min(size.width - 1, static_cast<int>(std::ceil(centre.x + reach)));
    for (int y = top; y <= bottom; ++y) {
      for (int x = left; x <= right; ++x) {
        if (std::hypot(x - centre.x, y - centre.y) <= reach) seen(y, x) = 1;
      }
    }
  }
  return seen;
}

/// Counts of surround and triangles; empty if the scale cannot give them.
struct Levels {
  double surround = 0, target = 0, noise = 0;
  [[nodiscard]] bool far_from(double end) const {
    if ((end - surround) * (target - surround) < 0) return true;  // the triangles are on the other side
    const double room = std::max({6 * noise, 0.1 * std::abs(target - surround), 2.0});
    return std::abs(end - surround) > std::abs(target - surround) + room;
  }
};

std::optional<Levels> levels_of(const AveragedPicture& picture, const RadiometricScale& scale, double contrast_k) {
  const double surround_k = median_of(picture.kelvin);
  const auto surround = scale.counts(surround_k), target = scale.counts(surround_k + contrast_k);
  if (!surround || !target) return std::nullopt;
  const auto slope = scale.kelvin_per_count(*surround);
  if (!slope) return std::nullopt;
  return Levels{*surround, *target, picture.temporal_noise_k / *slope};
}

}  // namespace

void SaturationWatch::learn_ends(const AveragedPicture& picture) {
  double lowest = 0, highest = 0;
  cv::minMaxIdx(picture.lowest, &lowest, nullptr);
  cv::minMaxIdx(picture.highest, nullptr, &highest);
  const int full_scale = (1 << picture.significant_bits) - 1;
  // A count beyond an end proves that it is none.
  if (defective_.empty() || highest > high_end_) high_end_ = full_scale;
  if (defective_.empty() || lowest < low_end_) low_end_ = 0;
  if (range_of_moving(picture) < noise_range_counts) return;
  if (cv::countNonZero(picture.lowest == highest) >= pixels_of_an_end)
    high_end_ = std::min(full_scale, static_cast<int>(highest));
  if (cv::countNonZero(picture.highest == lowest) >= pixels_of_an_end) low_end_ = static_cast<int>(lowest);
}

int SaturationWatch::learn(const AveragedPicture& picture, const RadiometricScale& scale,
                           const TargetPlate& mounted_plate, const Registration& registration, double contrast_k) {
  learn_ends(picture);
  const cv::Size size = picture.lowest.size();
  if (defective_.size() != size) defective_ = cv::Mat1b(size, std::uint8_t{0});
  const cv::Mat1b always_high = picture.lowest >= high_end_, always_low = picture.highest <= low_end_;
  const cv::Mat1b seen = seen_triangles(size, mounted_plate, registration);
  const auto levels = levels_of(picture, scale, contrast_k);
  const bool far_from_high = levels && levels->far_from(high_end_), far_from_low = levels && levels->far_from(low_end_);
  const cv::Mat1b always = always_high | always_low;
  const bool few = cv::countNonZero(always & (seen == 0)) <= most_defective * static_cast<double>(always.total());
  int of_triangles = 0;
  for (int row = 0; row < size.height; ++row) {
    for (int column = 0; column < size.width; ++column) {
      if (always(row, column) == 0) {
        defective_(row, column) = 0;
      } else if (seen(row, column) == 0 ? few : always_high(row, column) != 0 ? far_from_high : far_from_low) {
        defective_(row, column) = 1;
      }
      const bool ever = picture.highest(row, column) >= high_end_ || picture.lowest(row, column) <= low_end_;
      of_triangles += seen(row, column) != 0 && ever && defective_(row, column) == 0 ? 1 : 0;
    }
  }
  return of_triangles;
}

int SaturationWatch::saturated_pixels(const Frame& frame, const cv::Rect& window) const {
  int count = 0;
  for (int row = window.y; row < window.y + window.height; ++row) {
    for (int column = window.x; column < window.x + window.width; ++column) {
      const bool known = !defective_.empty() && defective_(row, column) != 0;
      count += !known && at_end(frame.counts(row, column)) ? 1 : 0;
    }
  }
  return count;
}

bool saturated(const AveragedPicture& picture) {
  constexpr double noted = 0.001;
  SaturationWatch watch;
  watch.learn_ends(picture);
  const cv::Mat1b always = (picture.lowest >= watch.high_end_) | (picture.highest <= watch.low_end_);
  return cv::countNonZero(always) > noted * static_cast<double>(always.total());
}

}  // namespace todbench
