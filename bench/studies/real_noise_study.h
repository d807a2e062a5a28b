// The observer's acuity under the noise of a recording, beside its acuity under white noise of the same strength.
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

/// Noise that a recording holds: each pixel without its mean over a block of successive frames, which takes scene,
/// fixed pattern and drift out. In the unit of the frames, and scaled so that the variance is that of single frames.
/// Noise that remembers loses with the mean what is slower than a block; tod/measures/temporal_noise.h says how much
/// that is.
struct RecordedNoise {
  std::vector<cv::Mat1f> frames;
  std::vector<int> block_of_frame;
  int blocks = 0;
  cv::Mat1b usable;           ///< as given, or 0 where the scene moved: temporal noise above twice the median pixel's
  double usable_share = 0;    ///< of the pixels
  double temporal_noise = 0;  ///< standard deviation over usable pixels, of what a block holds
  double correlation_x = 0, correlation_y = 0;  ///< of neighbours in a row and in a column, whole-frame changes removed
  ThreeDNoise components;                       ///< of usable pixels; mean of the blocks' variances; fixed components
                                                ///< contain the scene
};

/// Blocks of `block_frames` frames (at least 2; what is left over at the end is not used). `invalid_input`: fewer
/// frames than that, frames of different sizes, or no noise at all. `usable`: the pixels to take
/// (TemporalNoise::usable); empty: they are found here.
[[nodiscard]] Result<RecordedNoise> recorded_noise(std::span<const cv::Mat1f> frames, int block_frames,
                                                   const cv::Mat1b& usable = {});

/// White noise in the same frames and blocks, with the same standard deviation in every pixel.
[[nodiscard]] RecordedNoise white_like(const RecordedNoise& noise, std::uint64_t seed);

struct RealNoiseOptions {
  std::vector<double> contrast_over_noise{1.6, 3.3, 8, 28};  ///< 3.3: 0.23 K at a NETD of 0.07 K
  /// Noise of a whole frame over that of successive frames (TemporalNoise::whole_to_successive): what the observer
  /// suffers of noise that remembers.
  double whole_to_successive = 1;
  int draws = 2000;  ///< noise windows per size, spread over the recording; all phases and orientations share them
  std::uint64_t seed = 1;
  std::stop_token stop{};
};

struct SizeEstimate {
  double s75_pitch = 0;
  double se_ln = 0;  ///< by leaving out one block at a time (jackknife)
};

/// One contrast.
struct NoiseAcuity {
  double contrast_over_noise = 0;
  SizeEstimate real, white;
  double acuity_ratio = 0;  ///< under real noise / under white noise of the same standard deviation
  Interval ratio_ci95;      ///< Student's t with blocks - 1 degrees of freedom
  /// Standard deviation of the noise in the differences of the templates, relative to white noise of the same strength:
  /// what the observer's decisions see of it. Below 1 the noise disturbs less than its NETD says.
  double template_noise_ratio = 1;
  double predicted_ratio = 1;  ///< of acuities, from white noise of template_noise_ratio times the strength
  /// Acuity under white noise of the strength of a whole frame / of that which successive frames show, the latter taken
  /// as the unit of the contrast; nothing: the stronger noise leaves no threshold.
  std::optional<double> memory_acuity_ratio;
  /// Shares of template_noise_ratio^2: pixel noise, rows, columns from the 3D components, and what they leave over,
  /// which is noise correlated over neighbouring pixels (positive: low frequencies).
  double pixel_share = 1, row_share = 0, column_share = 0, correlated_share = 0;
};

/// Degraded triangles of `sensor` (pitches of the recording's pixels) are added to noise windows of the recording; the
/// observer answers. `invalid_input` when a contrast has no threshold or no window is free of moving scene; too few
/// blocks (below 4) are replaced by 16 parts of the picture as what the intervals are made from.
[[nodiscard]] Result<std::vector<NoiseAcuity>> real_noise_study(const RecordedNoise& noise, const SensorSpec& sensor,
                                                                TemplateObserver& observer,
                                                                const RealNoiseOptions& options);

}  // namespace todbench
