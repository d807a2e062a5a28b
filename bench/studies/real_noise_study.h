// SPDX-License-Identifier: GPL-3.0-or-later
// Acuity of the observer with the noise of a recording, compared with the acuity with white noise of the same standard
// deviation.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "hvs/observer/template_observer.h"
#include "sim_devices/sensor/sensor_spec.h"
#include "tod/measures/three_d_noise.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Noise of a recording: each pixel minus its mean over a block of successive frames. The subtraction removes scene,
/// fixed pattern and drift. The noise is in the unit of the frames and scaled to the variance of single frames. If the
/// noise is correlated in time, the subtraction also removes variation slower than a block;
/// tod/measures/temporal_noise.h quantifies this loss.
struct RecordedNoise {
  std::vector<cv::Mat1f> frames;
  std::vector<int> block_of_frame;
  int blocks = 0;
  /// Usable pixels as given to recorded_noise(). If no pixels were given, 0 marks pixels where the scene moved: their
  /// temporal noise exceeds twice the noise of the median pixel.
  cv::Mat1b usable;
  double usable_share = 0;    ///< share of usable pixels
  double temporal_noise = 0;  ///< standard deviation over usable pixels, within a block
  /// Correlations of neighbours in a row and in a column, without changes of the whole frame.
  double correlation_x = 0, correlation_y = 0;
  /// 3-D noise of the usable pixels, as means of the variances of the blocks; the fixed components include the scene.
  ThreeDNoise components;
};

/// Returns the noise of a recording, computed in blocks of `block_frames` frames (at least 2). Incomplete blocks are
/// ignored. `usable`: the pixels to use (TemporalNoise::usable); empty: the function selects the pixels. Errors:
/// `invalid_input` (fewer frames than a block, frames of different sizes, no noise).
[[nodiscard]] Result<RecordedNoise> recorded_noise(std::span<const cv::Mat1f> frames, int block_frames,
                                                   const cv::Mat1b& usable = {});

/// Returns white noise in the same frames and blocks, with the same standard deviation in every pixel.
[[nodiscard]] RecordedNoise white_like(const RecordedNoise& noise, std::uint64_t seed);

/// Options of the study.
struct RealNoiseOptions {
  std::vector<double> contrast_over_noise{1.6, 3.3, 8, 28};  ///< contrasts over the noise; 3.3 is 0.23 K at 0.07 K NETD
  /// Noise of a whole frame divided by the noise of successive frames (TemporalNoise::whole_to_successive). The ratio
  /// quantifies how noise that is correlated in time affects the observer.
  double whole_to_successive = 1;
  /// Noise windows per size, spread over the recording. All phases and orientations use the same windows.
  int draws = 2000;
  std::uint64_t seed = 1;
  std::stop_token stop{};
};

/// 75 % size with its standard error.
struct SizeEstimate {
  double s75_pitch = 0;
  double se_ln = 0;  ///< standard error of ln S75, by a jackknife over the blocks
};

/// Result at one contrast.
struct NoiseAcuity {
  double contrast_over_noise = 0;
  SizeEstimate real, white;
  double acuity_ratio = 0;  ///< acuity with real noise over acuity with white noise of the same standard deviation
  Interval ratio_ci95;      ///< 95 % interval of the ratio, by Student's t with blocks - 1 degrees of freedom
  /// Standard deviation of the noise in the differences of the templates, relative to white noise of the same strength.
  /// Only this part of the noise affects the observer's decisions. If the ratio is below 1, the noise has less effect
  /// than white noise of the same NETD.
  double template_noise_ratio = 1;
  /// Ratio of acuities that is predicted for white noise whose strength is multiplied by template_noise_ratio.
  double predicted_ratio = 1;
  /// Acuity with white noise of the strength of a whole frame, divided by the acuity with white noise of the strength
  /// of successive frames. Contrasts are in units of the noise of successive frames. Empty: there is no threshold with
  /// the stronger noise.
  std::optional<double> memory_acuity_ratio;
  /// Shares of template_noise_ratio^2: pixel noise, row noise and column noise from the 3-D components. The remainder
  /// is noise correlated over neighbouring pixels (positive: low frequencies).
  double pixel_share = 1, row_share = 0, column_share = 0, correlated_share = 0;
};

/// Adds images of triangles through `sensor` to noise windows of the recording, and lets the observer answer. The pitch
/// of `sensor` is the pitch of the pixels of the recording. With fewer than 4 blocks, the intervals come from 16 parts
/// of the picture instead. Errors: `invalid_input` if a contrast has no threshold or every window contains a moving
/// scene.
[[nodiscard]] Result<std::vector<NoiseAcuity>> real_noise_study(const RecordedNoise& noise, const SensorSpec& sensor,
                                                                TemplateObserver& observer,
                                                                const RealNoiseOptions& options);

}  // namespace todbench
