// SPDX-License-Identifier: GPL-3.0-or-later
// Conditions under which the counts of a recording contain no noise that could be stated.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <string_view>

#include "acquisition/base/result.h"
#include "acquisition/core/frame.h"

namespace todbench {

/// Returns kelvin per count at the level of the picture; 0: unknown.
[[nodiscard]] double kelvin_per_count(const Frame& frame, const RadiometricScale& scale);
/// Returns 1 for each pixel at either end of the counts, else 0.
[[nodiscard]] cv::Mat1b saturated_pixels(const Frame& frame);

/// Whether so many pixels, as a share of all, are saturated that the noise is clipped.
[[nodiscard]] bool noise_clipped(double saturated_share);
/// Whether noise is so low that rounding makes it depend on the level between two counts. `unit_per_count`: of the unit
/// of the noise; 0: unknown.
[[nodiscard]] bool noise_too_coarse(double noise, double unit_per_count);
/// A sentence for clipped noise.
[[nodiscard]] std::string clipped_sentence(double saturated_share);
/// A sentence for noise below half a count.
inline constexpr std::string_view too_coarse_sentence =
    "the noise is below half a count: the counts are too coarse to measure it";
/// States how many frames are no exposures of their own; empty if all are.
[[nodiscard]] std::string frozen_sentence(int repeated);
/// The error `invalid_input` of a recording with fewer than two separate exposures.
[[nodiscard]] Error too_few_frames(int frames, int repeated);

}  // namespace todbench
