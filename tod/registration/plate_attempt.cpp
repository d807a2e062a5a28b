// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/registration/plate_attempt.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "tod/plate/plate_outlines.h"
#include "tod/registration/shift_fit.h"

namespace todbench {
namespace {

constexpr double extra_rotation_deg = 10;  // searched beyond the limit, so that a wrong rotation can be reported
constexpr double reach_px = 2.5;           // of the fit from the place that the blobs suggest

/// The blur that explains the located triangles best: golden section on its logarithm from 0.2 to 1.6 px.
double best_blur(const cv::Mat1d& picture, const cv::Matx33d& mapping, const PlateAttempt& at) {
  std::vector<Polygon> outlines;
  for (std::size_t i = 0; i < at.located.size(); ++i) {
    outlines.push_back(outline_in_picture(mapping, at.located[i], at.located[i].apex));
    const cv::Point2d move = at.pixels[i] - to_pixel(mapping, at.located[i].position_mm);
    for (cv::Point2d& p : outlines.back()) p += move;
  }
  const double ratio = std::numbers::phi - 1;
  double low = std::log(0.2), high = std::log(1.6);
  double a = high - ratio * (high - low), b = low + ratio * (high - low);
  const auto cost = [&](double log_blur) { return misfit(picture, outlines, std::exp(log_blur)); };
  double cost_a = cost(a), cost_b = cost(b);
  while (high - low > 0.02) {
    if (cost_a < cost_b) {
      high = b;
      b = a;
      cost_b = cost_a;
      a = high - ratio * (high - low);
      cost_a = cost(a);
    } else {
      low = a;
      a = b;
      cost_a = cost_b;
      b = low + ratio * (high - low);
      cost_b = cost(b);
    }
  }
  return std::exp((low + high) / 2);
}

/// Place of the triangle if it points to `apex`, and the quality of that explanation.
std::optional<ShiftFit> locate(const cv::Mat1d& picture, const cv::Matx33d& mapping, const PlateTriangle& t, Apex apex,
                               double blur_px) {
  const Polygon outline = outline_in_picture(mapping, t, apex);
  return fit_shift(picture, std::span(&outline, 1), blur_px, {0, 0}, reach_px);
}

/// Determines the orientation of each large triangle (smallest unexplained variance of the four shapes, each at its
/// best place) and locates those that point as the plate states.
void judge(const PlateSearch& search, PlateAttempt& at) {
  for (const PlateTriangle& t : at.large) {
    std::optional<Apex> seen;
    std::optional<ShiftFit> best;
    for (const Apex apex : all_apexes) {
      auto fit = locate(search.picture, at.match.plate_to_pixel, t, apex, first_blur_px);
      if (!fit || fit->amplitudes[0] * at.sign <= 0) continue;
      if (best && fit->unexplained >= best->unexplained) continue;
      best = std::move(fit);
      seen = apex;
    }
    // Half of the variance unexplained: the window shows another object, or none.
    if (!best || best->unexplained > 0.5) continue;
    ++at.judged;
    if (*seen != t.apex) continue;
    at.located.push_back(t);
    at.pixels.push_back(to_pixel(at.match.plate_to_pixel, t.position_mm) + best->shift);
  }
}

/// The index of the triangle that disturbs the fit most, and the fit without it.
std::pair<std::size_t, FittedMapping> without_worst(const PlateAttempt& at, const RegistrationOptions& options) {
  std::pair<std::size_t, FittedMapping> best;
  for (std::size_t i = 0; i < at.located.size(); ++i) {
    auto plate = places_of(at.located);
    auto pixels = at.pixels;
    plate.erase(plate.begin() + static_cast<std::ptrdiff_t>(i));
    pixels.erase(pixels.begin() + static_cast<std::ptrdiff_t>(i));
    const FittedMapping others = fit_mapping(plate, pixels, options);
    if (i == 0 || others.residual_px < best.second.residual_px) best = {i, others};
  }
  return best;
}

}  // namespace

std::vector<cv::Point2d> places_of(const std::vector<PlateTriangle>& triangles) {
  std::vector<cv::Point2d> result;
  result.reserve(triangles.size());
  for (const PlateTriangle& t : triangles) result.push_back(t.position_mm);
  return result;
}

PlateSearch search_for(const cv::Mat1d& picture, const TargetPlate& plate, const RegistrationOptions& options) {
  const double scale = options.expected_scale_px_per_mm;
  const auto large = triangles_from(plate, options.min_triangle_px / scale);
  const auto [smallest, largest] = std::ranges::minmax(large, {}, &PlateTriangle::size_mm);
  // The size of a blob is the square root of its area in pixels.
  const double blob_scale = scale / std::sqrt(options.pixel_aspect);
  const double low = smallest.size_mm * blob_scale * (1 - searched_scale_range);
  const double high = largest.size_mm * blob_scale * (1 + searched_scale_range);
  return {picture, options, {find_warm_blobs(picture, low, high), find_warm_blobs(-picture, low, high)}};
}

std::optional<PlateAttempt> attempt_mounting(const PlateSearch& search, const TargetPlate& plate, Mounting relative) {
  const TargetPlate turned = mounted(plate, relative);
  const double scale = search.options.expected_scale_px_per_mm, aspect = search.options.pixel_aspect;
  // The layout is matched in a picture whose pixels are as high as wide.
  const MatchLimits limits{scale,
                           searched_scale_range,
                           search.options.max_rotation_deg + extra_rotation_deg,
                           {search.picture.cols, cvRound(search.picture.rows * aspect)}};
  std::optional<PlateAttempt> best;
  for (std::size_t side = 0; side < 2; ++side) {
    PlateAttempt at;
    at.mounting = turned.mounting;
    at.sign = side == 0 ? 1 : -1;
    at.large = triangles_from(turned, search.options.min_triangle_px / scale);
    std::vector<Blob> blobs = search.blobs[side];
    for (Blob& blob : blobs) {
      blob.centre.y *= aspect;
      blob.size_px *= std::sqrt(aspect);
    }
    auto match = match_layout(at.large, blobs, limits);
    if (!match || (best && !match->better_than(best->match))) continue;
    at.match = std::move(*match);
    at.match.plate_to_pixel = with_own_pixels(at.match.plate_to_pixel, aspect);
    best = std::move(at);
  }
  const int needed = std::min(credible_pairs, search.options.min_triangles);
  if (best && best->pairs() >= needed) judge(search, *best);
  return best;
}

FittedMapping refine_attempt(const PlateSearch& search, PlateAttempt& at) {
  FittedMapping fitted = fit_mapping(places_of(at.located), at.pixels, search.options);
  for (int round = 0; round < 2; ++round) {
    at.blur_px = best_blur(search.picture, fitted.plate_to_pixel, at);
    for (std::size_t i = 0; i < at.located.size(); ++i) {
      const auto fit = locate(search.picture, fitted.plate_to_pixel, at.located[i], at.located[i].apex, at.blur_px);
      if (fit) at.pixels[i] = to_pixel(fitted.plate_to_pixel, at.located[i].position_mm) + fit->shift;
    }
    fitted = fit_mapping(places_of(at.located), at.pixels, search.options);
  }
  // A third of the residual remains when one of eight is removed: F(2, 10) = 40, for a given one by chance once in 60
  // 000. Below 0.02 px it has no effect.
  constexpr double decisive = 3;
  constexpr double harmless_px = 0.02;
  while (static_cast<int>(at.located.size()) > search.options.min_triangles && fitted.residual_px > harmless_px) {
    const auto [worst, others] = without_worst(at, search.options);
    const bool acceptable = fitted.residual_px <= search.options.max_residual_px;
    if (acceptable && others.residual_px * decisive > fitted.residual_px) break;
    at.located.erase(at.located.begin() + static_cast<std::ptrdiff_t>(worst));
    at.pixels.erase(at.pixels.begin() + static_cast<std::ptrdiff_t>(worst));
    fitted = others;
  }
  return fitted;
}

}  // namespace todbench
