// Noise of pixels in time: a definition that no block length enters, and how the noise remembers.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

/// A picture with its place in time.
struct TimedPicture {
  cv::Mat1f picture;
  std::uint64_t sequence = 0;  ///< counts exposures; a gap is a frame that is missing
  int segment = 0;             ///< pictures of two segments are not compared: the camera corrected itself between them
};

/// In the unit of the pictures.
struct TemporalNoise {
  /// Standard deviation of a pixel from successive frames, sqrt(mean d^2 / 2). Of white noise it is the standard
  /// deviation; noise that remembers from frame to frame shows less of itself so, by sqrt(1 - lag1_correlation).
  double successive = 0;
  /// Structure function: sqrt(mean d^2 / 2) over pixels and pairs of frames so many exposures apart. Lags without a
  /// pair are left out; the first is that of `successive`.
  std::vector<int> lags;
  std::vector<double> structure;
  /// What a single frame carries of noise that changes within the longest lag, over what successive frames show,
  /// without changes of whole frames, which move no decision. 1 for white noise.
  double whole_to_successive = 1;
  /// Of a pixel in successive frames, for noise of first order, changes of whole frames left out; nothing: too few
  /// frames to say.
  std::optional<double> lag1_correlation;
  cv::Mat1b usable;  ///< 0: the scene moved there (more than twice the median pixel's), or the pixel never changes
  double usable_share = 1;  ///< of the pixels
};

/// Longest lag of the structure function.
inline constexpr int longest_lag = 64;

/// `invalid_input`: no two pictures of one segment, pictures of different sizes, or no noise at all. Of each lag at
/// most 128 pairs, evenly spread over the sequence, are compared.
[[nodiscard]] Result<TemporalNoise> temporal_noise(std::span<const TimedPicture> pictures);

/// Whether whole frames are at another level behind a jump, as behind a correction, and not only up and down: the means
/// of the levels of successive frames before and behind it differ by more than six of their standard errors. Of fewer
/// than five frames in all nobody knows: true.
[[nodiscard]] bool level_stays_changed(std::span<const double> before, std::span<const double> behind);

/// The lag-1 correlation of noise of first order (Box and Jenkins 1970, 3.2.3) whose squared structure function at
/// `lag`
/// >= 2 is `ratio` times that at lag 1: the root of 1 + rho + ... + rho^(lag - 1) = ratio, in [-1, 1]. Neither a mean
/// nor a variance over the sequence enters it, and slow drift little.
[[nodiscard]] double first_order_correlation(double ratio, int lag);

}  // namespace todbench
