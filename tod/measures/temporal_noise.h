// SPDX-License-Identifier: GPL-3.0-or-later
// Temporal noise of pixels, defined independently of the length of a block of frames, and its correlation in time.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// A picture with its place in time.
struct TimedPicture {
  cv::Mat1f picture;
  std::uint64_t sequence = 0;  ///< counts exposures; a gap is a missing frame
  int segment = 0;  ///< changes at a correction of the camera; pictures of different segments are not compared
};

/// Result of temporal_noise(), in the unit of the pictures.
struct TemporalNoise {
  /// Standard deviation of a pixel from successive frames, sqrt(mean d^2 / 2). For white noise this is the standard
  /// deviation; for noise with memory it is lower by sqrt(1 - lag1_correlation).
  double successive = 0;
  /// Structure function: sqrt(mean d^2 / 2) over pixels and pairs of frames at each lag in exposures. Lags without a
  /// pair are omitted; the first one is the lag of `successive`.
  std::vector<int> lags;
  std::vector<double> structure;
  /// Ratio of the structure function at the longest lag with enough pairs to `successive`. Both exclude changes of
  /// whole frames, which do not affect decisions. It is the ratio of the noise of a single frame to the noise in
  /// successive frames, as far as the noise changes within that lag. 1 for white noise.
  double whole_to_successive = 1;
  /// Lag-1 correlation of a pixel for noise of first order, without changes of whole frames; empty: too few frames.
  std::optional<double> lag1_correlation;
  /// Whether the noise differs between the first and the second half of the successive frames: their mean squares,
  /// without changes of whole frames, have a ratio above 1.15 (7 % of the noise), which chance exceeds in less than
  /// 1e-9 of all recordings, even if whole rows or columns cause the noise. They also differ by more than five standard
  /// errors from the scatter between pairs of frames, because some cameras disturb single frames. False for fewer than
  /// eight pairs.
  bool changes = false;
  /// 0 for a pixel that never changes, or where the scene moved (more than twice the median pixel's noise).
  cv::Mat1b usable;
  double usable_share = 1;  ///< share of the pixels
};

/// Longest lag of the structure function.
inline constexpr int longest_lag = 64;

/// Measures the temporal noise. Compares at most 128 pairs per lag, which are evenly spread over the sequence. Errors:
/// `invalid_input` (no two pictures of one segment, pictures of different sizes, or no noise).
[[nodiscard]] Result<TemporalNoise> temporal_noise(std::span<const TimedPicture> pictures);

/// Returns whether the level of whole frames stays changed after a jump, as after a correction. `before` and `behind`:
/// levels of successive frames before and after the jump. True if their means differ by more than six standard errors
/// of the difference. Also true with fewer than five frames in total or no frames on one side, because the test is then
/// not possible.
[[nodiscard]] bool level_stays_changed(std::span<const double> before, std::span<const double> behind);

/// Returns the lag-1 correlation of noise of first order (Box and Jenkins 1970, 3.2.3) whose squared structure function
/// at `lag` >= 2 is `ratio` times that at lag 1. It is the root of 1 + rho + ... + rho^(lag - 1) = ratio, in [-1, 1].
/// It is independent of mean and variance over the sequence, and slow drift affects it little.
[[nodiscard]] double first_order_correlation(double ratio, int lag);

}  // namespace todbench
