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

/// Counts the pixels with the lowest and with the highest value of a recording, the extreme values. In a flat scene
/// with noise, an extreme value has fewer pixels than the adjacent value. If a device clips below full scale, an
/// extreme value has many pixels.
class EndValues {
 public:
  /// Adds a picture. `usable`: pixels that are not 0 are counted; empty: all pixels.
  void add(const cv::Mat1f& picture, const cv::Mat1b& usable);
  /// Returns the share of pixels with an extreme value if their number exceeds the number at the next value by five
  /// standard errors; otherwise 0.
  [[nodiscard]] double clipped_share() const;

 private:
  struct End {
    float value = 0, next_value = 0;
    double pixels = 0, next_pixels = 0;
    void add(float value);
  };
  End high_, low_;  ///< highest and lowest value; the lowest value is stored as the highest of the negated values
  double pixels_ = 0;
};

/// Properties of a recording that limit the noise that can be measured from it.
struct NoiseLimits {
  double saturated_share = 0;  ///< share of saturated_pixels() in all frames
  double unit_per_count = 1;   ///< one count in the unit of the noise; 0: unknown
  int counts_per_step = 1;     ///< CountStep::counts_per_step()
  double clipped_share = 0;    ///< EndValues::clipped_share()
};
/// Reason why a recording does not show the noise of its camera.
struct NoiseFault {
  std::string_view verdict;  ///< "saturated" or "too_coarse"
  std::string message;
};
/// Returns the reason why a noise cannot be stated. The reasons are too many saturated pixels, pixels that are clipped
/// below full scale, and noise below half a step of the counts. Rounding makes this small noise depend on the position
/// of the level between two steps. Empty: the noise can be stated. `noise`: in the unit of NoiseLimits::unit_per_count.
[[nodiscard]] std::optional<NoiseFault> noise_fault(const NoiseLimits& limits, double noise);
/// Returns a phrase with the number of frames that repeat the previous frame bit for bit; empty if no frame does.
[[nodiscard]] std::string frozen_sentence(int repeated);
/// Returns the error `invalid_input` for a recording with fewer than two different frames.
[[nodiscard]] Error too_few_frames(int frames, int repeated);

}  // namespace todbench
