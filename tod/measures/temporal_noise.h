// SPDX-License-Identifier: GPL-3.0-or-later
// Temporal noise of pixels and its correlation in time. The definition does not depend on the number of frames in a
// block.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// A picture with its position in the sequence.
struct TimedPicture {
  cv::Mat1f picture;
  std::uint64_t sequence = 0;  ///< counts exposures; a gap is a missing frame
  int segment = 0;  ///< changes at a correction of the camera; pictures of different segments are not compared
};

/// Result of temporal_noise(), in the unit of the pictures.
struct TemporalNoise {
  /// sqrt(mean d^2 / 2), where d is the difference of a pixel between successive frames. For white noise this is the
  /// standard deviation. For noise with memory it is lower than the standard deviation by the factor sqrt(1 -
  /// lag1_correlation).
  double successive = 0;
  /// Structure function: sqrt(mean d^2 / 2) over pixels and pairs of frames at each lag. Lags are in exposures. Lags
  /// without a pair are omitted, and the first lag is that of `successive`.
  std::vector<int> lags;
  std::vector<double> structure;
  /// Structure function at the longest lag with enough pairs, divided by that of successive frames. Changes of whole
  /// frames are removed from both values, because these changes do not affect decisions. If the noise is independent at
  /// the longest lag, the ratio is the noise of a single frame divided by the noise in successive frames. 1 for white
  /// noise.
  double whole_to_successive = 1;
  /// Lag-1 correlation of a pixel for noise of first order, without changes of whole frames; empty: too few frames.
  std::optional<double> lag1_correlation;
  /// Whether the noise differs between the first and the second half of the successive frames. The mean squares of the
  /// halves, without changes of whole frames, must meet two conditions. First, the ratio of the mean squares is above
  /// 1.15 (7 % of the noise). Chance exceeds this limit in less than 1e-9 of all recordings, even if whole rows or
  /// columns cause the noise. Second, the mean squares differ by more than five standard errors, which are computed
  /// from the scatter between pairs of frames. The second condition is needed because some cameras disturb single
  /// frames. False for fewer than eight pairs.
  bool changes = false;
  /// Not 0: the pixel is usable. 0: the pixel never changes, or has more than twice the noise of the median pixel,
  /// which indicates a moving scene.
  cv::Mat1b usable;
  double usable_share = 1;  ///< share of usable pixels
};

/// Longest lag of the structure function.
inline constexpr int longest_lag = 64;

/// Measures the temporal noise. At most 128 pairs per lag, evenly spread over the sequence, are compared. Errors:
/// `invalid_input` (no two pictures of one segment, pictures of different sizes, or no noise).
[[nodiscard]] Result<TemporalNoise> temporal_noise(std::span<const TimedPicture> pictures);

/// Returns whether a jump of the level of whole frames is permanent, as after a correction. `before` and `behind`:
/// levels of successive frames before and after the jump. True if the means of `before` and `behind` differ by more
/// than six standard errors of the difference. Also true if the test is not possible: fewer than five frames in total,
/// or no frames before or after the jump.
[[nodiscard]] bool level_stays_changed(std::span<const double> before, std::span<const double> behind);

/// Returns whether two mean squares of successive differences have a ratio above 1.15 (7 % of the noise), and above the
/// value that chance exceeds in less than 1e-9 of all recordings. `samples`: number of differences in each mean square
/// that are independent, except for the correlation of -1/2 due to common frames, which is taken into account. If one
/// mean square is 0, every other value differs from it.
[[nodiscard]] bool mean_squares_differ(double before, double after, double samples);

/// Returns the lag-1 correlation rho of noise of first order (Box and Jenkins 1970, 3.2.3). `ratio`: squared structure
/// function at `lag` >= 2, divided by that at lag 1. rho is the root of 1 + rho + ... + rho^(lag - 1) = ratio in [-1,
/// 1]. The mean and the variance over the sequence have no effect on rho, and slow drift has little effect.
[[nodiscard]] double first_order_correlation(double ratio, int lag);

}  // namespace todbench
