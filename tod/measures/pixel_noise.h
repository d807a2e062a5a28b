// Temporal noise of pixels from one cube of frames, by the definitions that data sheets use, side by side.
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <utility>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

/// In the unit of the frames. T frames; variances of a pixel over frames divide by T - 1.
struct PixelNoise {
  int frames = 0;
  double sd_rms = 0;                      ///< root of the mean variance of the pixels: the temporal noise
  std::pair<double, double> sd_rms_ci95;  ///< chi-squared with pixels x (T - 1): for independent pixels and frames
  double sd_rms_detrended = 0;            ///< the same without each pixel's straight line in time (divides by T - 2)
  double sd_frame_differences = 0;        ///< sqrt(mean d^2 / 2) of successive frames: low by sqrt(1 - rho)
  double mean_of_pixel_sd = 0;            ///< low by c4 and by the spread of the pixels: what some data sheets state
  double c4 = 1;                          ///< mean of the standard deviation of T normal values over their true one
  double mean_of_pixel_sd_corrected = 0;  ///< mean_of_pixel_sd / c4
  double median_pixel_sd = 0;             ///< hides noisy pixels
  /// Variance over pixels of the mean frame without sd_rms^2 / T, which the temporal noise leaves in it; signed.
  double fixed_pattern_variance = 0;
  cv::Mat1d pixel_sd;    ///< of each pixel
  cv::Mat1d mean_frame;  ///< over time
};

/// Frames of one cube, in order, with no correction between them. `invalid_input`: fewer than three frames or two
/// pixels, frames of different sizes, a value that is not finite.
[[nodiscard]] Result<PixelNoise> pixel_noise(std::span<const cv::Mat1d> frames);

/// Where a scale is too coarse for its noise to be measured: below half a count rounding eats it, and what is left
/// depends on where between two counts the mean lies (at 0.3 counts from 0.10 to 0.17 counts^2).
inline constexpr double least_measurable_noise_counts = 0.5;

/// Variance of a normal value with this standard deviation after rounding to whole counts; `phase_counts` is the mean's
/// distance from a whole count. sd^2 + 1/12 where the noise is above a count.
[[nodiscard]] double variance_of_rounded(double sd_counts, double phase_counts);

}  // namespace todbench
