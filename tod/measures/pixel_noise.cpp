// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/pixel_noise.h"

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>

#include "acquisition/base/distributions.h"
#include "acquisition/base/try.h"
#include "tod/measures/medians.h"

namespace todbench {
namespace {

/// Sums over frames of each pixel's changes from the first frame.
struct TimeSums {
  cv::Mat1d change, squares, ramp, steps;
};

TimeSums sums_of(std::span<const cv::Mat1d> frames) {
  const cv::Size size = frames[0].size();
  TimeSums sums{cv::Mat1d::zeros(size), cv::Mat1d::zeros(size), cv::Mat1d::zeros(size), cv::Mat1d::zeros(size)};
  const double middle = 0.5 * (static_cast<double>(frames.size()) - 1);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const cv::Mat1d change = frames[k] - frames[0];
    sums.change += change;
    sums.squares += change.mul(change);
    sums.ramp += (static_cast<double>(k) - middle) * change;
    if (k == 0) continue;
    const cv::Mat1d step = frames[k] - frames[k - 1];
    sums.steps += step.mul(step);
  }
  return sums;
}

/// c4(n) of statistical process control: sqrt(2 / (n - 1)) Gamma(n / 2) / Gamma((n - 1) / 2).
double c4_of(double count) {
  return std::sqrt(2 / (count - 1)) / boost::math::tgamma_delta_ratio((count - 1) / 2, 0.5);
}

Result<void> check(std::span<const cv::Mat1d> frames) {
  if (frames.size() < 3 || frames[0].total() < 2)
    return fail(ErrorCode::invalid_input, "the temporal noise of pixels needs at least three frames of two pixels");
  for (const cv::Mat1d& frame : frames) {
    if (frame.size() != frames[0].size()) return fail(ErrorCode::invalid_input, "the frames have different sizes");
    if (!cv::checkRange(frame)) return fail(ErrorCode::invalid_input, "a frame contains a value that is not finite");
  }
  return {};
}

}  // namespace

Result<PixelNoise> pixel_noise(std::span<const cv::Mat1d> frames) {
  TODBENCH_TRY_VOID(check(frames));
  const double n = static_cast<double>(frames.size()), pixels = static_cast<double>(frames[0].total());
  const TimeSums sums = sums_of(frames);
  cv::Mat1d about_mean = sums.squares - sums.change.mul(sums.change) / n;
  about_mean = cv::max(about_mean, 0.0);
  // Squares explained by a straight line in time: (sum (k - middle) x)^2 / sum (k - middle)^2.
  const cv::Mat1d of_line = sums.ramp.mul(sums.ramp) / (n * (n * n - 1) / 12);
  PixelNoise noise;
  noise.frames = static_cast<int>(frames.size());
  cv::sqrt(about_mean / (n - 1), noise.pixel_sd);
  noise.mean_frame = frames[0] + sums.change / n;
  const double variance = cv::mean(about_mean)[0] / (n - 1);
  noise.sd_rms = std::sqrt(variance);
  const distribution::ChiSquared squares(pixels * (n - 1));
  noise.sd_rms_ci95 = {noise.sd_rms * std::sqrt(pixels * (n - 1) / distribution::quantile(complement(squares, 0.025))),
                       noise.sd_rms * std::sqrt(pixels * (n - 1) / distribution::quantile(squares, 0.025))};
  noise.sd_rms_detrended = std::sqrt(std::max(0.0, cv::mean(about_mean - of_line)[0]) / (n - 2));
  noise.sd_frame_differences = std::sqrt(cv::mean(sums.steps)[0] / (n - 1) / 2);
  noise.mean_of_pixel_sd = cv::mean(noise.pixel_sd)[0];
  noise.c4 = c4_of(n);
  noise.mean_of_pixel_sd_corrected = noise.mean_of_pixel_sd / noise.c4;
  noise.median_pixel_sd = median_of(noise.pixel_sd);
  cv::Scalar mean, sd;
  cv::meanStdDev(noise.mean_frame - cv::mean(noise.mean_frame)[0], mean, sd);
  noise.fixed_pattern_variance = sd[0] * sd[0] * pixels / (pixels - 1) - variance / n;
  return noise;
}

}  // namespace todbench
