// SPDX-License-Identifier: GPL-3.0-or-later
// Conditions under which the noise of a recording cannot be stated, and their messages.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "acquisition/base/result.h"
#include "acquisition/core/frame.h"

namespace todbench {

/// Returns the kelvin per count at the mean level of the frame; 0: unknown.
[[nodiscard]] double kelvin_per_count(const Frame& frame, const RadiometricScale& scale);
/// Returns 1 for each pixel with the lowest or highest possible count, otherwise 0.
[[nodiscard]] cv::Mat1b saturated_pixels(const Frame& frame);

/// Counts the pixels at the highest and the lowest value of a recording. Noise spreads the values of a flat scene, so
/// that fewer pixels have an end value than the value next to it. A device that clips below full scale collects pixels
/// at an end value.
class EndValues {
 public:
  /// Adds a picture. `usable`: pixels that are not 0 are counted; empty: all pixels.
  void add(const cv::Mat1f& picture, const cv::Mat1b& usable);
  /// Returns the share of pixels at an end value where they exceed the next value by five standard errors; 0: none.
  [[nodiscard]] double clipped_share() const;

 private:
  struct End {
    float value = 0, next_value = 0;
    double pixels = 0, next_pixels = 0;
    void add(float value);
  };
  End high_, low_;  ///< of the values, and of the values with the other sign
  double pixels_ = 0;
};

/// Properties of a recording that limit which noise it can show.
struct NoiseLimits {
  double saturated_share = 0;  ///< of the pixels of all frames, see saturated_pixels()
  double unit_per_count = 1;   ///< in the unit of the noise; 0: unknown
  int counts_per_step = 1;     ///< of CountStep
  double clipped_share = 0;    ///< of EndValues
};
/// Reason why a recording does not show the noise of its camera.
struct NoiseFault {
  std::string_view verdict;  ///< "saturated" or "too_coarse"
  std::string message;
};
/// Returns the reason why a noise cannot be stated: too many saturated pixels, noise below half a step of the counts
/// (after rounding it depends on the position of the level between two steps), or pixels that are clipped below full
/// scale. Empty if there is none.
[[nodiscard]] std::optional<NoiseFault> noise_fault(const NoiseLimits& limits, double noise);
/// Returns a phrase with the number of frames that repeat the previous frame bit for bit; empty if no frame does.
[[nodiscard]] std::string frozen_sentence(int repeated);
/// Returns the error `invalid_input` for a recording with fewer than two different frames.
[[nodiscard]] Error too_few_frames(int frames, int repeated);

}  // namespace todbench
