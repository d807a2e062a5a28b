// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/pixel_defects.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "acquisition/base/median.h"
#include "acquisition/base/try.h"
#include "tod/measures/medians.h"
#include "tod/measures/pixel_blinking.h"
#include "tod/measures/pixel_noise.h"
#include "tod/measures/pixel_substitution.h"

namespace todbench {
namespace {

constexpr int least_frames = 16, least_frames_blinking = 48, least_side = 8;

Result<void> check_cube(std::span<const cv::Mat1f> frames) {
  if (frames.size() < least_frames)
    return fail(ErrorCode::invalid_input,
                fmt::format("the test for defective pixels needs at least {} frames", least_frames));
  for (const cv::Mat1f& frame : frames) {
    if (frame.size() != frames[0].size()) return fail(ErrorCode::invalid_input, "the frames have different sizes");
    if (frame.rows < least_side || frame.cols < least_side)
      return fail(ErrorCode::invalid_input,
                  fmt::format("the test for defective pixels needs at least {0} x {0} pixels", least_side));
    if (!cv::checkRange(frame)) return fail(ErrorCode::invalid_input, "a frame contains a value that is not finite");
  }
  return {};
}

cv::Mat1d mean_of(std::span<const cv::Mat1f> frames) {
  cv::Mat1d sum = cv::Mat1d::zeros(frames[0].size());
  for (const cv::Mat1f& frame : frames) cv::add(sum, frame, sum, cv::noArray(), CV_64F);
  return sum / static_cast<double>(frames.size());
}

/// Medians, so that a pixel that jumps does not affect its neighbours.
void remove_row_medians(cv::Mat1f& picture) {
  std::vector<double> values(static_cast<std::size_t>(picture.cols));
  for (int y = 0; y < picture.rows; ++y) {
    float* row = picture[y];
    std::copy(row, row + picture.cols, values.begin());
    const auto middle = static_cast<float>(median(values));
    for (int x = 0; x < picture.cols; ++x) row[x] -= middle;
  }
}

/// Independent part of each pixel in time: pixels in rows, frames in columns.
cv::Mat1f series_of(std::span<const cv::Mat1f> frames, const cv::Mat1d& mean) {
  const auto pixels = static_cast<int>(mean.total());
  cv::Mat1f series(pixels, static_cast<int>(frames.size()));
  cv::Mat1f mean_values;
  mean.convertTo(mean_values, CV_32F);
  for (int t = 0; t < series.cols; ++t) {
    cv::Mat1f change = frames[static_cast<std::size_t>(t)] - mean_values;
    remove_row_medians(change);
    cv::Mat1f turned = change.t();
    remove_row_medians(turned);
    change = turned.t();
    const float* value = change[0];
    for (int p = 0; p < pixels; ++p) series(p, t) = value[p];
  }
  for (int p = 0; p < pixels; ++p) {
    float* values = series[p];
    const auto middle = static_cast<float>(std::accumulate(values, values + series.cols, 0.0) / series.cols);
    for (int t = 0; t < series.cols; ++t) values[t] -= middle;
  }
  return series;
}

cv::Mat1d sd_of(const cv::Mat1f& series, cv::Size size) {
  cv::Mat1d sd(size);
  for (int p = 0; p < series.rows; ++p)
    sd(p / size.width, p % size.width) = cv::norm(series.row(p)) / std::sqrt(series.cols - 1.0);
  return sd;
}

cv::Mat1b constant_pixels(std::span<const cv::Mat1f> frames) {
  cv::Mat1b constant(frames[0].size(), 255);
  for (const cv::Mat1f& frame : frames) constant &= frame == frames[0];
  return constant;
}

/// Expected number of live pixels that show one count only, for noise in counts with the most favourable mean.
double expected_constant(double noise_counts, int frames, double pixels) {
  return pixels * std::pow(std::erf(0.5 / (noise_counts * std::numbers::sqrt2)), frames);
}

cv::Mat1b unresponsive_pixels(const cv::Mat1d& responsivity, const BadPixelRules& rules, int& tested) {
  cv::Mat1b out = cv::Mat1b::zeros(responsivity.size());
  std::vector<double> known;
  for (const double value : responsivity)
    if (std::isfinite(value)) known.push_back(value);
  tested = static_cast<int>(known.size());
  if (known.empty()) return out;
  const double middle = median(known);
  if (middle == 0) return out;
  for (int y = 0; y < out.rows; ++y) {
    for (int x = 0; x < out.cols; ++x) out(y, x) = responds_badly(responsivity(y, x) / middle, rules) ? 255 : 0;
  }
  return out;
}

/// The size of each pixel's cluster.
cv::Mat1i clusters_of(const cv::Mat1b& defective) {
  cv::Mat1i size = cv::Mat1i::zeros(defective.size());
  for (int y = 0; y < defective.rows; ++y) {
    for (int x = 0; x < defective.cols; ++x) {
      if (defective(y, x) == 0 || size(y, x) != 0) continue;
      std::vector<cv::Point> members{{x, y}};
      size(y, x) = -1;
      for (std::size_t next = 0; next < members.size(); ++next) {
        const cv::Point at = members[next];
        for (int v = std::max(0, at.y - 1); v <= std::min(defective.rows - 1, at.y + 1); ++v) {
          for (int u = std::max(0, at.x - 1); u <= std::min(defective.cols - 1, at.x + 1); ++u) {
            if (defective(v, u) == 0 || size(v, u) != 0) continue;
            size(v, u) = -1;
            members.emplace_back(u, v);
          }
        }
      }
      for (const cv::Point member : members) size(member) = static_cast<int>(members.size());
    }
  }
  return size;
}

}  // namespace

std::string_view to_string(PixelDefect kind) {
  constexpr std::array<std::string_view, pixel_defect_kinds.size()> names{"stuck", "offset",   "unresponsive",
                                                                          "noisy", "blinking", "substituted"};
  return names[static_cast<std::size_t>(kind)];
}

Result<PixelDefects> pixel_defects(std::span<const cv::Mat1f> frames, const PixelScene& scene,
                                   const PixelDefectRules& rules) {
  TODBENCH_TRY_VOID(check_cube(frames));
  const cv::Size size = frames[0].size();
  PixelDefects out;
  out.frames = static_cast<int>(frames.size());
  const cv::Mat1d mean = mean_of(frames);
  out.mean_frame = scene.shading.empty() ? mean.clone() : cv::Mat1d(mean - scene.shading);
  const cv::Mat1f series = series_of(frames, mean);
  out.noise_sd = sd_of(series, size);
  const double noise = median_of(out.noise_sd);
  const double noise_counts = scene.unit_per_count ? noise / *scene.unit_per_count : 0;
  if (scene.unit_per_count && noise_counts < least_measurable_noise_counts)
    return fail(ErrorCode::invalid_input, "the scale is too coarse to show the noise of a pixel");
  TODBENCH_TRY(const auto common, bad_pixels({.offset = out.mean_frame, .noise_sd = out.noise_sd}, rules.bad));
  for (cv::Mat1b& map : out.found) map = cv::Mat1b::zeros(size);
  const auto map = [&](PixelDefect kind) -> cv::Mat1b& { return out.found[static_cast<std::size_t>(kind)]; };
  map(PixelDefect::offset) = common.offset;
  map(PixelDefect::noisy) = common.noisy;
  const cv::Mat1b constant = constant_pixels(frames);
  if (!scene.unit_per_count || expected_constant(noise_counts, out.frames, static_cast<double>(size.area())) < 0.01)
    map(PixelDefect::stuck) = constant;
  else
    out.not_tested.emplace_back("stuck pixels: too few frames for the coarse scale");
  if (!scene.responsivity.empty())
    map(PixelDefect::unresponsive) = unresponsive_pixels(scene.responsivity, rules.bad, out.response_tested);
  if (out.frames >= least_frames_blinking) {
    map(PixelDefect::blinking) = blinking_pixels(series, size, {rules.blinking, rules.levels, noise});
  } else {
    out.not_tested.push_back(fmt::format("blinking pixels: fewer than {} frames", least_frames_blinking));
  }
  const auto replaced = substituted_pixels(
      frames, constant, {.chance = rules.chance, .unit_per_count = scene.unit_per_count.value_or(0)});
  map(PixelDefect::substituted) = replaced.found;
  if (!replaced.tested) out.not_tested.emplace_back("substituted pixels: too few frames or a scale that is too coarse");
  out.bad = cv::Mat1b::zeros(size);
  for (const PixelDefect kind : pixel_defect_kinds)
    if (kind != PixelDefect::substituted) out.bad |= out.of(kind);
  out.defective = out.bad | out.of(PixelDefect::substituted);
  out.cluster = clusters_of(out.defective);
  return out;
}

ZoneCount count_zone(const PixelDefects& defects, const cv::Rect& field, const cv::Rect& zone) {
  const cv::Rect seen = zone & field;
  ZoneCount count{.pixels = zone.area(), .measured = seen.area()};
  if (seen.empty()) return count;
  const cv::Rect inside = seen - field.tl();
  count.bad = cv::countNonZero(defects.bad(inside));
  count.substituted = cv::countNonZero(defects.of(PixelDefect::substituted)(inside));
  // A cluster is counted at its first pixel in the zone, and then erased.
  cv::Mat1i left = defects.cluster.clone();
  for (int y = inside.y; y < inside.y + inside.height; ++y) {
    for (int x = inside.x; x < inside.x + inside.width; ++x) {
      const int size = left(y, x);
      if (size == 0) continue;
      count.largest_cluster = std::max(count.largest_cluster, size);
      if (size >= 2) ++count.clusters;
      std::vector<cv::Point> open{{x, y}};
      left(y, x) = 0;
      while (!open.empty()) {
        const cv::Point at = open.back();
        open.pop_back();
        for (int v = std::max(0, at.y - 1); v <= std::min(left.rows - 1, at.y + 1); ++v) {
          for (int u = std::max(0, at.x - 1); u <= std::min(left.cols - 1, at.x + 1); ++u) {
            if (left(v, u) == 0) continue;
            left(v, u) = 0;
            open.emplace_back(u, v);
          }
        }
      }
    }
  }
  return count;
}

}  // namespace todbench
