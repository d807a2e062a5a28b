// SPDX-License-Identifier: GPL-3.0-or-later
// Temporal noise of pixels from one cube of frames, by the definitions used in data sheets.
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <utility>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// Temporal noise of one cube of T frames, in the unit of the frames. A pixel's variance over frames has the divisor T
/// - 1.
struct PixelNoise {
  int frames = 0;
  double sd_rms = 0;  ///< root of the mean variance of the pixels: the temporal noise
  /// Interval of sd_rms for independent pixels and frames: chi-squared with pixels x (T - 1) degrees of freedom.
  std::pair<double, double> sd_rms_ci95;
  double sd_rms_detrended = 0;      ///< sd_rms after removal of a straight line in time from each pixel (divisor T - 2)
  double sd_frame_differences = 0;  ///< rms difference of successive frames / sqrt(2); too low for noise with memory
  /// Mean of the pixels' standard deviations, stated in some data sheets. This mean is too low by the factor c4, and
  /// also because of the spread of the pixels.
  double mean_of_pixel_sd = 0;
  double c4 = 1;  ///< mean of the standard deviation of T normal values, divided by the true standard deviation
  double mean_of_pixel_sd_corrected = 0;  ///< mean_of_pixel_sd / c4
  double median_pixel_sd = 0;             ///< median of the pixels' standard deviations; insensitive to noisy pixels
  /// Variance of the mean frame over pixels, minus sd_rms^2 / T, the contribution of the temporal noise; signed.
  double fixed_pattern_variance = 0;
  cv::Mat1d pixel_sd;    ///< standard deviation of each pixel over time
  cv::Mat1d mean_frame;  ///< mean over time
};

/// Measures the noise in the frames of one cube, in order, without a correction between them. Errors: `invalid_input`
/// (fewer than three frames or two pixels, frames of different sizes, a value that is not finite).
[[nodiscard]] Result<PixelNoise> pixel_noise(std::span<const cv::Mat1d> frames);

/// Smallest noise that can be measured, in counts. If the noise is below half a count, the measured variance depends on
/// the position of the mean between two counts. For a noise of 0.3 counts, the measured variance is between 0.10 and
/// 0.17 counts^2.
inline constexpr double least_measurable_noise_counts = 0.5;

}  // namespace todbench
