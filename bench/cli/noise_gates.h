// SPDX-License-Identifier: GPL-3.0-or-later
// Conditions under which the noise of a recording cannot be stated, and their messages.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <string_view>

#include "acquisition/base/result.h"
#include "acquisition/core/frame.h"

namespace todbench {

/// Returns the kelvin per count at the mean level of the frame; 0: unknown.
[[nodiscard]] double kelvin_per_count(const Frame& frame, const RadiometricScale& scale);
/// Returns 1 for each pixel with the lowest or highest possible count, otherwise 0.
[[nodiscard]] cv::Mat1b saturated_pixels(const Frame& frame);

/// Returns whether the share of saturated pixels is so large that the noise is clipped.
[[nodiscard]] bool noise_clipped(double saturated_share);
/// Returns whether the noise is so low that, after rounding to counts, it depends on the position of the level between
/// two counts. `unit_per_count`: size of a count in the unit of the noise; 0: unknown.
[[nodiscard]] bool noise_too_coarse(double noise, double unit_per_count);
/// Returns the message about clipped noise.
[[nodiscard]] std::string clipped_sentence(double saturated_share);
/// Message about noise below half a count.
inline constexpr std::string_view too_coarse_sentence =
    "the noise is below half a count: the counts are too coarse to measure it";
/// Returns a phrase with the number of frames that repeat the previous frame bit for bit; empty if no frame does.
[[nodiscard]] std::string frozen_sentence(int repeated);
/// Returns the error `invalid_input` for a recording with fewer than two different frames.
[[nodiscard]] Error too_few_frames(int frames, int repeated);

}  // namespace todbench
