// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/registration/plate_mapping.h"

#include <cmath>
#include <vector>

#include "acquisition/base/distributions.h"
#include "tod/plate/plate_outlines.h"
#include "tod/registration/homography.h"
#include "tod/registration/layout_matching.h"

namespace todbench {
namespace {

double sum_of_squares(const cv::Matx33d& h, std::span<const cv::Point2d> plate_mm,
                      std::span<const cv::Point2d> pixels) {
  double sum = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const cv::Point2d d = pixels[i] - to_pixel(h, plate_mm[i]);
    sum += d.dot(d);
  }
  return sum;
}

/// Least squares of x' = a x + b y + c and the same for y'.
cv::Matx33d fit_affine(std::span<const cv::Point2d> plate_mm, std::span<const cv::Point2d> pixels) {
  const int n = static_cast<int>(pixels.size());
  cv::Mat1d design(n, 3), wanted(n, 2), solution;
  for (int i = 0; i < n; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    design(i, 0) = plate_mm[k].x;
    design(i, 1) = plate_mm[k].y;
    design(i, 2) = 1;
    wanted(i, 0) = pixels[k].x;
    wanted(i, 1) = pixels[k].y;
  }
  cv::solve(design, wanted, solution, cv::DECOMP_SVD);
  return {solution(0, 0), solution(1, 0), solution(2, 0), solution(0, 1), solution(1, 1), solution(2, 1), 0, 0, 1};
}

/// Standard deviations of the places along their two principal axes, the smaller over the larger: 0 on a line.
double flatness(std::span<const cv::Point2d> plate_mm) {
  cv::Point2d mean{0, 0};
  for (const cv::Point2d& p : plate_mm) mean += p / static_cast<double>(plate_mm.size());
  double xx = 0, yy = 0, xy = 0;
  for (const cv::Point2d& p : plate_mm) {
    const cv::Point2d d = p - mean;
    xx += d.x * d.x;
    yy += d.y * d.y;
    xy += d.x * d.y;
  }
  const double middle = (xx + yy) / 2;
  const double spread = std::hypot((xx - yy) / 2, xy);
  return middle + spread > 0 ? std::sqrt(std::max(0.0, middle - spread) / (middle + spread)) : 0;
}

/// Whether `larger` explains more of the residuals of `smaller` than chance does.
bool demanded(double smaller_sum, int smaller_parameters, double larger_sum, int larger_parameters, int equations) {
  const double exact = 1e-12 * equations;  // residuals of a millionth of a pixel are rounding, not tilt
  if (smaller_sum <= exact) return false;
  const int more = larger_parameters - smaller_parameters;
  const int freedom = equations - larger_parameters;
  const double f = (smaller_sum - larger_sum) / more / (std::max(larger_sum, exact) / freedom);
  return f > distribution::quantile(distribution::complement(distribution::FisherF(more, freedom), 0.01));
}

}  // namespace

cv::Matx33d with_square_pixels(const cv::Matx33d& mapping, double pixel_aspect) {
  return pixel_aspect == 1 ? mapping : cv::Matx33d(1, 0, 0, 0, pixel_aspect, 0, 0, 0, 1) * mapping;
}

cv::Matx33d with_own_pixels(const cv::Matx33d& mapping, double pixel_aspect) {
  return with_square_pixels(mapping, 1 / pixel_aspect);
}

FittedMapping fit_mapping(std::span<const cv::Point2d> plate_mm, std::span<const cv::Point2d> own_pixels,
                          const RegistrationOptions& options) {
  const int n = static_cast<int>(own_pixels.size());
  std::vector<cv::Point2d> pixels(own_pixels.begin(), own_pixels.end());
  for (cv::Point2d& p : pixels) p.y *= options.pixel_aspect;
  FittedMapping best;
  best.plate_to_pixel = fit_similarity(plate_mm, pixels, options.expected_scale_px_per_mm);
  best.mapping = n == 1 ? PlateMapping::translation : PlateMapping::similarity;
  double sum = sum_of_squares(best.plate_to_pixel, plate_mm, pixels);
  int parameters = 4;
  constexpr double least_flatness = 0.2;
  const auto consider = [&](const cv::Matx33d& h, PlateMapping mapping, int its_parameters) {
    const double its_sum = sum_of_squares(h, plate_mm, pixels);
    if (!demanded(sum, parameters, its_sum, its_parameters, 2 * n)) return;
    best.plate_to_pixel = h;
    best.mapping = mapping;
    sum = its_sum;
    parameters = its_parameters;
  };
  if (n >= 5 && flatness(plate_mm) > least_flatness) {
    consider(fit_affine(plate_mm, pixels), PlateMapping::affine, 6);
    if (n >= 6) {
      if (const auto h = fit_homography(plate_mm, pixels)) consider(*h, PlateMapping::homography, 8);
    }
  }
  best.residual_px = std::sqrt(sum / n);
  best.plate_to_pixel = with_own_pixels(best.plate_to_pixel, options.pixel_aspect);
  return best;
}

}  // namespace todbench
