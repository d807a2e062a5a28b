// Four bars as their profile across: is every gap lower than the bars beside it?
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "tod/range/mrtd_formula.h"

namespace todbench {

/// Mean along the bars over the rows (horizontal) or columns within their length, at least one. The pattern is in the
/// middle of the window.
[[nodiscard]] std::vector<float> bar_profile(const cv::Mat1f& window, double frequency_per_sample, BarAxis axis);

/// The least by which a gap lies below the lower of the bars beside it; of a bar counts its largest sample within
/// max(w / 2, 1 / 2) of its centre, of a gap its smallest (as tod/range/bars_sampled.h). `offset`: of the pattern's
/// middle from that of the profile, in samples. Above 0: four bars.
[[nodiscard]] double shallowest_gap(std::span<const double> profile, double frequency_per_sample, double offset);

}  // namespace todbench
