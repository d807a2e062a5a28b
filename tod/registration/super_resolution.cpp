// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/registration/super_resolution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>

#include "acquisition/base/try.h"

namespace todbench {
namespace {

constexpr int smallest_side = 16;

/// Cubic Lagrange weights for the four neighbours -1, 0, 1, 2 of a place between 0 and 1. Exact for cubics, which
/// follow the blurred picture.
std::array<double, 4> cubic_weights(double t) {
  return {-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2,
          (t + 1) * t * (t - 1) / 6};
}

/// image(x + shift) for x in `region`, which lies inside including its margin.
cv::Mat1f displaced(const cv::Mat1f& image, cv::Point2d shift, cv::Rect region) {
  const int ix = static_cast<int>(std::floor(shift.x)), iy = static_cast<int>(std::floor(shift.y));
  const auto wx = cubic_weights(shift.x - ix);
  const auto wy = cubic_weights(shift.y - iy);
  cv::Mat1f out(region.size());
  for (int row = 0; row < region.height; ++row) {
    for (int column = 0; column < region.width; ++column) {
      double value = 0;
      for (int j = 0; j < 4; ++j) {
        const float* line = image.ptr<float>(region.y + row + iy + j - 1) + region.x + column + ix - 1;
        double sum = 0;
        for (std::size_t i = 0; i < 4; ++i) sum += wx[i] * static_cast<double>(line[i]);
        value += wy[static_cast<std::size_t>(j)] * sum;
      }
      out(row, column) = static_cast<float>(value);
    }
  }
  return out;
}

/// Region in which x, x + shift and the required neighbours lie inside.
cv::Rect common_region(cv::Size size, cv::Point2d shift) {
  const int left = 2 + std::max(0, static_cast<int>(std::ceil(-shift.x)));
  const int top = 2 + std::max(0, static_cast<int>(std::ceil(-shift.y)));
  const int right = size.width - 3 - std::max(0, static_cast<int>(std::ceil(shift.x)));
  const int bottom = size.height - 3 - std::max(0, static_cast<int>(std::ceil(shift.y)));
  return {left, top, std::max(0, right - left), std::max(0, bottom - top)};
}

/// One Gauss-Newton step for the shift; empty if the picture does not determine both directions.
std::optional<cv::Point2d> step(const cv::Mat1f& reference, const cv::Mat1f& frame, cv::Point2d shift,
                                cv::Rect region) {
  const cv::Mat1f moved = displaced(frame, shift, region);
  const cv::Mat1f fixed = reference(region);
  double n = 0, sx = 0, sy = 0, se = 0, xx = 0, xy = 0, yy = 0, xe = 0, ye = 0;
  for (int row = 1; row + 1 < moved.rows; ++row) {
    for (int column = 1; column + 1 < moved.cols; ++column) {
      const double gx = 0.5 * static_cast<double>(moved(row, column + 1) - moved(row, column - 1));
      const double gy = 0.5 * static_cast<double>(moved(row + 1, column) - moved(row - 1, column));
      const double e = static_cast<double>(moved(row, column) - fixed(row, column));
      n += 1;
      sx += gx, sy += gy, se += e;
      xx += gx * gx, xy += gx * gy, yy += gy * gy;
      xe += gx * e, ye += gy * e;
    }
  }
  // A common offset of all pixels is fitted with the shift.
  xx -= sx * sx / n, xy -= sx * sy / n, yy -= sy * sy / n;
  xe -= sx * se / n, ye -= sy * se / n;
  const double determinant = xx * yy - xy * xy;
  if (!(xx > 0 && yy > 0 && determinant > 1e-6 * xx * yy)) return std::nullopt;
  return cv::Point2d(-(yy * xe - xy * ye) / determinant, -(xx * ye - xy * xe) / determinant);
}

/// Offset of the best grid for the places, as a fraction of its step: circular mean of the places modulo 1 / factor.
double best_offset(const std::vector<double>& places, int factor) {
  std::complex<double> sum = 0;
  for (const double place : places) sum += std::polar(1.0, 2 * std::numbers::pi * place * factor);
  if (std::abs(sum) < 1e-9 * static_cast<double>(places.size())) return 0;
  return std::arg(sum) / (2 * std::numbers::pi);
}

struct Axis {
  std::vector<int> first_cell;  ///< cell of sample 0 of each frame
  double first_px = 0;          ///< place of cell 0
  double squares = 0;           ///< of the distances to the cells, in pixels
};

Axis placed_on_grid(const std::vector<double>& places, int factor) {
  const double offset = best_offset(places, factor);
  Axis axis;
  int lowest = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const double cell = places[k] * factor - offset;
    axis.first_cell.push_back(static_cast<int>(std::lround(cell)));
    axis.squares += std::pow((cell - axis.first_cell.back()) / factor, 2);
    if (k == 0 || axis.first_cell.back() < lowest) lowest = axis.first_cell.back();
  }
  // The picture covers the reference frame: its cell 0 is the lowest one inside that row of pixels.
  const int origin = std::max(lowest, axis.first_cell.front() - (factor - 1));
  for (int& cell : axis.first_cell) cell -= origin;
  axis.first_px = (origin + offset) / factor;
  return axis;
}

/// Fills each sample that no frame reaches: with the mean of the nearest samples that have a value, or with the first
/// of these. Searches in growing squares.
void fill_empty(cv::Mat1f& picture, const cv::Mat1i& counts, bool mean_of_nearest) {
  for (int row = 0; row < picture.rows; ++row) {
    for (int column = 0; column < picture.cols; ++column) {
      if (counts(row, column) > 0) continue;
      double sum = 0;
      int nearest = 0, found = 0;  // squared distance in samples, number of samples at it
      for (int reach = 1; found == 0 && reach < std::max(picture.rows, picture.cols); ++reach) {
        for (int j = std::max(0, row - reach); j <= std::min(picture.rows - 1, row + reach); ++j) {
          for (int i = std::max(0, column - reach); i <= std::min(picture.cols - 1, column + reach); ++i) {
            const int distance = (j - row) * (j - row) + (i - column) * (i - column);
            if (counts(j, i) == 0 || (found > 0 && distance > nearest)) continue;
            if (distance < nearest) sum = found = 0;
            if (found > 0 && !mean_of_nearest) continue;
            nearest = distance;
            sum += static_cast<double>(picture(j, i));
            ++found;
          }
        }
      }
      picture(row, column) = static_cast<float>(sum / std::max(1, found));
    }
  }
}

Result<void> check(const std::vector<cv::Mat1f>& frames, std::size_t shifts) {
  if (frames.empty()) return fail(ErrorCode::invalid_input, "super-resolution needs at least one frame");
  if (shifts != frames.size()) return fail(ErrorCode::invalid_input, "super-resolution needs one shift per frame");
  for (const auto& frame : frames) {
    if (frame.size() != frames.front().size() || frame.empty())
      return fail(ErrorCode::invalid_input, "super-resolution needs frames of one size");
  }
  return {};
}

}  // namespace

Result<cv::Point2d> frame_shift(const cv::Mat1f& reference, const cv::Mat1f& frame, double blur_sigma_px) {
  if (reference.size() != frame.size())
    return fail(ErrorCode::invalid_input, "frames of different sizes cannot be registered");
  if (reference.rows < smallest_side || reference.cols < smallest_side)
    return fail(ErrorCode::invalid_input, "frames of fewer than 16 pixels per side cannot be registered");
  // The level is removed, because a background of thousands of counts would cost digits.
  cv::Mat1f a = reference - cv::mean(reference)[0];
  cv::Mat1f b = frame - cv::mean(frame)[0];
  cv::GaussianBlur(a, a, {}, blur_sigma_px, blur_sigma_px, cv::BORDER_REPLICATE);
  cv::GaussianBlur(b, b, {}, blur_sigma_px, blur_sigma_px, cv::BORDER_REPLICATE);
  cv::Mat1f window;
  cv::createHanningWindow(window, a.size(), CV_32F);
  // Some versions of OpenCV apply the window to their arguments, so they get copies.
  const cv::Point2d start = cv::phaseCorrelate(a.clone(), b.clone(), window);
  const auto converged_from = [&](cv::Point2d shift) -> std::optional<cv::Point2d> {
    for (int iteration = 0; iteration < 50; ++iteration) {
      const cv::Rect region = common_region(a.size(), shift);
      if (2 * region.area() < a.size().area()) return std::nullopt;
      const auto move = step(a, b, shift, region);
      if (!move) return std::nullopt;
      shift += *move;
      if (std::hypot(move->x, move->y) < 1e-5) return shift;
    }
    return std::nullopt;
  };
  const auto residual = [&](cv::Point2d shift) {
    const cv::Rect region = common_region(a.size(), shift);
    if (2 * region.area() < a.size().area()) return 1e300;
    return cv::norm(displaced(b, shift, region), a(region), cv::NORM_L2SQR) / region.area();
  };
  // The phase correlation may fail in noise. Frames of one sequence are rarely far apart.
  std::optional<cv::Point2d> best;
  for (const cv::Point2d from : {start, cv::Point2d(0, 0)}) {
    if (!std::isfinite(from.x) || !std::isfinite(from.y)) continue;
    const auto found = converged_from(from);
    if (found && (!best || residual(*found) < residual(*best))) best = found;
  }
  if (!best) {
    return fail(ErrorCode::invalid_input,
                "two frames cannot be registered: too little structure, or less than half of the picture in common");
  }
  return *best;
}

Result<std::vector<cv::Point2d>> frame_shifts(const std::vector<cv::Mat1f>& frames) {
  std::vector<cv::Point2d> shifts;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (k == 0) {
      shifts.emplace_back(0, 0);
      continue;
    }
    auto shift = frame_shift(frames.front(), frames[k]);
    if (!shift) return fail("frame " + std::to_string(k), shift.error());
    shifts.push_back(*shift);
  }
  return shifts;
}

Result<SuperResolved> super_resolve(const std::vector<cv::Mat1f>& frames, const std::vector<cv::Point2d>& shifts_px,
                                    int factor, EmptyCells empty) {
  TODBENCH_TRY_VOID(check(frames, shifts_px.size()));
  if (factor < 1 || factor > 8) return fail(ErrorCode::invalid_input, "the factor of super-resolution must be 1 to 8");
  std::vector<double> xs, ys;
  for (const auto& shift : shifts_px) {
    // Sample 0 of a frame shows the place -shift of the reference.
    const cv::Point2d place = shifts_px.front() - shift;
    if (!(std::abs(place.x) < frames.front().cols && std::abs(place.y) < frames.front().rows))
      return fail(ErrorCode::invalid_input, "a shift of super-resolution is larger than the picture");
    xs.push_back(place.x);
    ys.push_back(place.y);
  }
  const Axis x = placed_on_grid(xs, factor), y = placed_on_grid(ys, factor);
  SuperResolved out;
  out.frames_per_cell = cv::Mat1i::zeros(factor, factor);
  const auto cell = [factor](int index) { return ((index % factor) + factor) % factor; };
  for (std::size_t k = 0; k < frames.size(); ++k) ++out.frames_per_cell(cell(y.first_cell[k]), cell(x.first_cell[k]));
  if (empty == EmptyCells::refused && cv::countNonZero(out.frames_per_cell) < factor * factor) {
    return fail(ErrorCode::invalid_input, "the shifts of " + std::to_string(frames.size()) + " frames fill only " +
                                              std::to_string(cv::countNonZero(out.frames_per_cell)) + " of the " +
                                              std::to_string(factor * factor) + " cells of a pixel");
  }
  const cv::Size size(frames.front().cols * factor, frames.front().rows * factor);
  cv::Mat1d sums = cv::Mat1d::zeros(size);
  cv::Mat1i counts = cv::Mat1i::zeros(size);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    for (int row = 0; row < frames[k].rows; ++row) {
      const int r = row * factor + y.first_cell[k];
      if (r < 0 || r >= size.height) continue;
      for (int column = 0; column < frames[k].cols; ++column) {
        const int c = column * factor + x.first_cell[k];
        if (c < 0 || c >= size.width) continue;
        sums(r, c) += static_cast<double>(frames[k](row, column));
        ++counts(r, c);
      }
    }
  }
  out.picture.create(size);
  for (int row = 0; row < size.height; ++row) {
    for (int column = 0; column < size.width; ++column)
      out.picture(row, column) = static_cast<float>(sums(row, column) / std::max(1, counts(row, column)));
  }
  fill_empty(out.picture, counts, empty == EmptyCells::interpolated);
  out.first_px = {x.first_px, y.first_px};
  out.placement_rms_px = std::sqrt((x.squares + y.squares) / (2 * static_cast<double>(frames.size())));
  return out;
}

Result<SuperResolved> super_resolve(const std::vector<cv::Mat1f>& frames) {
  TODBENCH_TRY(auto shifts, frame_shifts(frames));
  return super_resolve(frames, shifts);
}

}  // namespace todbench
