// SPDX-License-Identifier: GPL-3.0-or-later
// Profile across four bars, and the test whether every gap is lower than the bars next to it.
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "tod/range/mrtd_formula.h"

namespace todbench {

/// Returns the mean along the bars, over the rows (horizontal axis) or columns within the bars, without the last sample
/// at either end; at least two rows or columns. The pattern is in the middle of the window.
[[nodiscard]] std::vector<float> bar_profile(const cv::Mat1f& window, double frequency_per_sample, BarAxis axis);

/// Returns the smallest depth of a gap below the lower of its two bars; above 0, four bars are resolved. The level of a
/// bar is the largest sample within max(w / 2, 1 / 2) samples of its centre, w: width of a bar in samples. The level of
/// a gap is the smallest sample within the same distance of its centre (as tod/range/bars_sampled.h). `offset`: middle
/// of the pattern minus middle of the profile, in samples.
[[nodiscard]] double shallowest_gap(std::span<const double> profile, double frequency_per_sample, double offset);

}  // namespace todbench
