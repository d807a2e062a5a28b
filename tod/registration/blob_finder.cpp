// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/registration/blob_finder.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "acquisition/base/median.h"

namespace todbench {
namespace {

/// Structures above a surround wider than any blob: white top-hat (picture minus its opening) with the level of the
/// noise at zero.
cv::Mat1d relief(const cv::Mat1d& picture, double largest_px) {
  cv::Mat1d smooth;
  cv::GaussianBlur(picture, smooth, {}, 0.6, 0.6, cv::BORDER_REPLICATE);
  // The bounding box of a triangle is 1.52 times its size; rotated by 10 degrees and blurred it gains about 15 % and 3
  // px.
  const int width = 2 * static_cast<int>(std::ceil((1.52 * 1.15 * largest_px + 3) / 2)) + 1;
  cv::Mat1d result;
  cv::morphologyEx(smooth, result, cv::MORPH_TOPHAT, cv::getStructuringElement(cv::MORPH_RECT, {width, width}));
  result -= median({result.begin(), result.end()});
  return result;
}

struct Region {
  double area = 0, weight = 0;
  cv::Point2d moment{0, 0};
};

/// Collects the connected pixels above `level` round `seed`; each pixel is used only once.
Region grow(const cv::Mat1d& height, cv::Mat1b& taken, cv::Point seed, double level) {
  Region region;
  std::vector<cv::Point> open{seed};
  taken(seed) = 1;
  while (!open.empty()) {
    const cv::Point p = open.back();
    open.pop_back();
    region.area += 1;
    region.weight += height(p);
    region.moment += height(p) * cv::Point2d(p);
    for (const cv::Point step : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
      const cv::Point q = p + step;
      if (q.x < 0 || q.y < 0 || q.x >= height.cols || q.y >= height.rows) continue;
      if (taken(q) || height(q) < level) continue;
      taken(q) = 1;
      open.push_back(q);
    }
  }
  return region;
}

}  // namespace

std::vector<Blob> find_warm_blobs(const cv::Mat1d& picture, double smallest_px, double largest_px) {
  constexpr double noise_factor = 6;       // one false maximum in about 1e8 pixels of white noise
  constexpr double area_tolerance = 2.2;   // area above half height against the true area, for at least 2 px with blur
  constexpr std::size_t most_blobs = 120;  // limits the work of the matching; a plate has about twenty
  const cv::Mat1d height = relief(picture, largest_px);
  cv::Mat1d magnitude = cv::abs(height);
  const double noise = 1.4826 * median({magnitude.begin(), magnitude.end()});
  double highest = 0;
  cv::minMaxLoc(height, nullptr, &highest);
  const double threshold = std::max(noise_factor * noise, 1e-3 * highest);
  cv::Mat1d neighbourhood;
  cv::dilate(height, neighbourhood, cv::getStructuringElement(cv::MORPH_RECT, {3, 3}));
  std::vector<cv::Point> seeds;
  for (int y = 0; y < height.rows; ++y) {
    for (int x = 0; x < height.cols; ++x) {
      if (height(y, x) > threshold && height(y, x) == neighbourhood(y, x)) seeds.emplace_back(x, y);
    }
  }
  std::ranges::stable_sort(seeds, [&](const cv::Point& a, const cv::Point& b) { return height(a) > height(b); });
  cv::Mat1b taken = cv::Mat1b::zeros(height.size());
  std::vector<Blob> blobs;
  for (const cv::Point& seed : seeds) {
    if (taken(seed)) continue;
    const Region region = grow(height, taken, seed, height(seed) / 2);
    if (region.area < smallest_px * smallest_px / area_tolerance) continue;
    if (region.area > largest_px * largest_px * area_tolerance) continue;
    blobs.push_back({region.moment / region.weight, std::sqrt(region.area), height(seed)});
    if (blobs.size() == most_blobs) break;
  }
  return blobs;
}

}  // namespace todbench
