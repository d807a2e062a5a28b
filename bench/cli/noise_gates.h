// SPDX-License-Identifier: GPL-3.0-or-later
// Conditions under which the noise of a recording cannot be stated, and their messages.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "acquisition/base/result.h"
#include "acquisition/core/frame.h"

namespace todbench {

/// Returns the kelvin per count at the mean level of the frame; 0: unknown.
[[nodiscard]] double kelvin_per_count(const Frame& frame, const RadiometricScale& scale);
/// Returns 1 for each pixel with the lowest or highest possible count, otherwise 0.
[[nodiscard]] cv::Mat1b saturated_pixels(const Frame& frame);

/// Returns whether the share of saturated pixels is so large that the noise is clipped.
[[nodiscard]] bool noise_clipped(double saturated_share);
/// Returns whether the noise is so low that, after rounding to steps of the counts, it depends on the position of the
/// level between two steps. `unit_per_step`: size of a step in the unit of the noise; 0: unknown.
[[nodiscard]] bool noise_too_coarse(double noise, double unit_per_step);

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
/// Returns the message about clipped noise.
[[nodiscard]] std::string clipped_sentence(double saturated_share);
/// Returns the message about noise that is clipped below full scale.
[[nodiscard]] std::string clipped_below_sentence(double clipped_share);
/// Returns the message about noise below half a step. `counts_per_step`: of CountStep.
[[nodiscard]] std::string too_coarse_sentence(int counts_per_step);
/// Returns a phrase with the number of frames that repeat the previous frame bit for bit; empty if no frame does.
[[nodiscard]] std::string frozen_sentence(int repeated);
/// Returns the error `invalid_input` for a recording with fewer than two different frames.
[[nodiscard]] Error too_few_frames(int frames, int repeated);

}  // namespace todbench
