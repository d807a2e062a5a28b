// Dynamic super-resolution: frames that are shifted against each other by fractions of a pixel, registered and averaged
// on a finer grid. Works on frames of any camera.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

/// By how much the content of `frame` is displaced against `reference`, in pixels (x right, y down): what is at x in
/// the reference is at x + shift in the frame. Gauss-Newton on the squared difference (Lucas and Kanade 1981) after a
/// Gaussian blur of `blur_sigma_px`, which takes the undersampled frequencies out; the start is a phase correlation.
/// The difference of the means is not looked at. `invalid_input`: sizes differ, fewer than 16 pixels on a side, or
/// nothing in the picture that fixes both directions; also when less than half of the picture is common to both.
[[nodiscard]] Result<cv::Point2d> frame_shift(const cv::Mat1f& reference, const cv::Mat1f& frame,
                                              double blur_sigma_px = 1.5);

/// frame_shift() of every frame against the first; the first is {0, 0}.
[[nodiscard]] Result<std::vector<cv::Point2d>> frame_shifts(const std::vector<cv::Mat1f>& frames);

/// A picture with `factor` times as many samples per pixel and axis.
struct SuperResolved {
  cv::Mat1f picture;
  /// Where sample (0, 0) is, in pixels of the reference frame; the others follow at distances of 1 / factor.
  cv::Point2d first_px;
  /// Root mean square distance, per axis, between the places of the averaged samples and the grid, in pixels: 0 where
  /// the shifts are exact multiples of 1 / factor apart, 1 / (factor sqrt(12)) for shifts anywhere.
  double placement_rms_px = 0;
  /// Frames averaged in each of the factor x factor cells of a pixel. The noise of a sample falls with its square root.
  cv::Mat1i frames_per_cell;
};

/// Puts every sample of every frame into the nearest cell of the finer grid and averages there. The grid lies where it
/// fits the shifts best (circular mean). Cells beyond a frame's edge that no frame reaches repeat their nearest
/// neighbour. `invalid_input`: no frame, different sizes, one shift per frame missing or not finite, or shifts that
/// leave a cell of the pixel without any frame (at least factor^2 frames with different sub-pixel shifts are needed).
/// Pure.
[[nodiscard]] Result<SuperResolved> super_resolve(const std::vector<cv::Mat1f>& frames,
                                                  const std::vector<cv::Point2d>& shifts_px, int factor = 2);

/// The same with shifts from frame_shifts().
[[nodiscard]] Result<SuperResolved> super_resolve(const std::vector<cv::Mat1f>& frames);

}  // namespace todbench
