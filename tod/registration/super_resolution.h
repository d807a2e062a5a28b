// SPDX-License-Identifier: GPL-3.0-or-later
// Dynamic super-resolution: frames displaced by fractions of a pixel are registered and averaged on a finer grid. Works
// on frames of any camera.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// Displacement of the content of `frame` against `reference`, in pixels (x right, y down): a point at x in the
/// reference is at x + shift in the frame. Gauss-Newton on the squared difference (Lucas and Kanade 1981) after a
/// Gaussian blur of `blur_sigma_px`, which removes the undersampled frequencies. The iteration starts from a phase
/// correlation and ignores the difference of the means. Errors: `invalid_input` (sizes differ, fewer than 16 pixels on
/// a side, less than half of the picture common to both, or no structure that determines both directions).
[[nodiscard]] Result<cv::Point2d> frame_shift(const cv::Mat1f& reference, const cv::Mat1f& frame,
                                              double blur_sigma_px = 1.5);

/// frame_shift() of every frame against the first. The shift of the first is {0, 0}.
[[nodiscard]] Result<std::vector<cv::Point2d>> frame_shifts(const std::vector<cv::Mat1f>& frames);

/// A picture with `factor` times as many samples per pixel and axis.
struct SuperResolved {
  cv::Mat1f picture;
  /// Place of sample (0, 0) in pixels of the reference frame. The distance between samples is 1 / factor.
  cv::Point2d first_px;
  /// Root mean square distance, per axis, between averaged samples and the grid, in pixels: 0 if the shifts differ by
  /// exact multiples of 1 / factor, 1 / (factor sqrt(12)) for arbitrary shifts.
  double placement_rms_px = 0;
  /// Frames averaged in each of the factor x factor cells of a pixel. The noise of a sample falls with the square root
  /// of this number.
  cv::Mat1i frames_per_cell;
};

/// Treatment of a cell that no frame reaches.
enum class EmptyCells {
  refused,
  interpolated  ///< shows the mean of the nearest ones: no finer picture along an axis without displacement
};

/// Puts every sample of every frame into the nearest cell of the finer grid and averages there. The grid is placed to
/// fit the shifts best (circular mean). Cells beyond a frame's edge that no frame reaches repeat their nearest
/// neighbour. At least factor^2 frames with different sub-pixel shifts are needed to fill every cell. A pure function.
/// Errors: `invalid_input` (no frame, different sizes, a missing or non-finite shift, or an empty cell if these are
/// refused).
[[nodiscard]] Result<SuperResolved> super_resolve(const std::vector<cv::Mat1f>& frames,
                                                  const std::vector<cv::Point2d>& shifts_px, int factor = 2,
                                                  EmptyCells empty = EmptyCells::refused);

/// Same with the shifts of frame_shifts().
[[nodiscard]] Result<SuperResolved> super_resolve(const std::vector<cv::Mat1f>& frames);

}  // namespace todbench
