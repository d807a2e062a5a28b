// SPDX-License-Identifier: GPL-3.0-or-later
// Noise of a camera from an uninterrupted series of frames.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <stop_token>
#include <vector>

#include "acquisition/base/result.h"
#include "acquisition/core/radiometric_scale.h"
#include "tod/measurement/frame_taker.h"
#include "tod/measures/three_d_noise.h"

namespace todbench {

/// Noise of a cube of frames of the plate at a contrast of 0, in kelvin of the camera's scale.
struct NoiseMeasure {
  int frames = 0, rows = 0, columns = 0;  ///< rows and columns of the part of the picture that the plate covers
  std::uint64_t first_frame = 0, last_frame = 0;
  /// Time from the correction to the last frame; empty: no correction is known.
  std::optional<double> since_correction_s{};
  double mean_k = 0;  ///< mean temperature reported by the camera
  NoiseTable table;   ///< noise components after removal of the shading
  double shading_range_k = 0, shading_sd_k = 0;
  std::optional<double> lag1_correlation{};
  std::optional<double> noise_counts{};  ///< temporal noise in steps of the camera's counts; empty: not known
  cv::Rect field{};                      ///< part of the frame that the plate covers
  cv::Mat1d pixel_sd_k{};                ///< temporal noise of each pixel, after removal of changes of whole frames
  cv::Mat1d pattern_k{};                 ///< mean frame minus its mean and shading
};

/// Options of measure_series_noise().
struct NoiseOptions {
  int frames = 64;                         ///< number of frames, at least 5
  cv::Rect field;                          ///< part of the frame that the plate covers
  std::optional<cv::Rect> pixel_window{};  ///< window of each frame that is kept for the test of pixels; empty: none
};

/// Result of measure_series_noise().
struct NoiseSeries {
  NoiseMeasure noise;
  std::optional<double> kelvin_per_step{};  ///< step of the counts in the frames (CountStep); empty: not known
  std::vector<cv::Mat1f> pixel_frames{};    ///< the pixel window in at most `most_pixel_frames` frames, in kelvin
};

/// Takes frames of a constant scene, without a non-uniformity correction between them, and evaluates their noise.
/// Errors: `integrity` (corrections interrupted three series, the picture changed abruptly, or the noise changed),
/// those of FrameTaker::next(), window_kelvin() and NoiseCube.
[[nodiscard]] Result<NoiseSeries> measure_series_noise(FrameTaker& taker, const RadiometricScale& scale,
                                                       const NoiseOptions& options, const std::stop_token& stop);

/// Returns the kelvin per count at a temperature; empty if the scale does not state it.
[[nodiscard]] std::optional<double> kelvin_per_count_at(const RadiometricScale& scale, double at_k);

}  // namespace todbench
