// SPDX-License-Identifier: GPL-3.0-or-later
// Dynamic super-resolution: registers frames that are displaced by fractions of a pixel, and averages them on a finer
// grid. Suitable for frames of any camera.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// Returns the displacement of the content of `frame` relative to `reference`, in pixels (x right, y down): a point at
/// x in the reference is at x + shift in the frame. The squared difference of the pictures is minimised by Gauss-Newton
/// steps (Lucas and Kanade 1981), starting from a phase correlation. A Gaussian blur of `blur_sigma_px` first removes
/// the undersampled frequencies. The difference of the means is ignored. Errors: `invalid_input` (sizes differ, fewer
/// than 16 pixels on a side, less than half of the picture common to both, or no structure that determines both
/// directions).
[[nodiscard]] Result<cv::Point2d> frame_shift(const cv::Mat1f& reference, const cv::Mat1f& frame,
                                              double blur_sigma_px = 1.5);

/// Returns frame_shift() of every frame relative to the first frame, whose shift is {0, 0}. Errors as frame_shift().
[[nodiscard]] Result<std::vector<cv::Point2d>> frame_shifts(const std::vector<cv::Mat1f>& frames);

/// A picture with `factor` times as many samples per pixel and axis.
struct SuperResolved {
  cv::Mat1f picture;
  /// Position of sample (0, 0) in pixels of the reference frame. The distance between samples is 1 / factor.
  cv::Point2d first_px;
  /// Root mean square distance, per axis, between averaged samples and the grid, in pixels. The distance is 0 if the
  /// shifts differ by exact multiples of 1 / factor, and 1 / (factor sqrt(12)) for arbitrary shifts.
  double placement_rms_px = 0;
  /// Number of frames averaged in each of the factor x factor cells of a pixel. The noise of a sample decreases with
  /// the square root of this number.
  cv::Mat1i frames_per_cell;
};

/// Treatment of a cell into which no frame falls.
enum class EmptyCells {
  refused,
  /// The cell is set to the mean of the nearest cells. Along an axis without displacement, the resolution of the
  /// picture is then not finer.
  interpolated
};

/// Assigns every sample of every frame to the nearest cell of the finer grid and averages in each cell. The position of
/// the grid is the best fit to the shifts (circular mean). At the border of the picture, a cell without a sample is set
/// to the value of the nearest cell. At least factor^2 frames with different sub-pixel shifts are needed to fill every
/// cell. A pure function. Errors: `invalid_input` (no frame, different sizes, a missing or non-finite shift, or an
/// empty cell with EmptyCells::refused).
[[nodiscard]] Result<SuperResolved> super_resolve(const std::vector<cv::Mat1f>& frames,
                                                  const std::vector<cv::Point2d>& shifts_px, int factor = 2,
                                                  EmptyCells empty = EmptyCells::refused);

/// Computes the picture with the shifts of frame_shifts(). Errors: those of frame_shifts() and super_resolve().
[[nodiscard]] Result<SuperResolved> super_resolve(const std::vector<cv::Mat1f>& frames);

}  // namespace todbench
