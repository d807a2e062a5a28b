// SPDX-License-Identifier: GPL-3.0-or-later
// Drift of a camera after a non-uniformity correction: change of the mean and increase of the spatial noise.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "acquisition/base/interval.h"
#include "acquisition/base/result.h"

namespace todbench {

/// Successive frames of a flat field, averaged.
struct DriftGroup {
  double time_s = 0;  ///< mean time since the correction
  int frames = 0;
  cv::Mat1d mean_k;
};

/// Form of the change with time.
enum class DriftShape {
  linear,    ///< proportional to the time t since the first group
  approach,  ///< 1 - exp(-t / T): exponential change towards a limit
};
[[nodiscard]] std::string_view to_string(DriftShape shape);

/// One quantity over time.
struct DriftFit {
  DriftShape shape = DriftShape::linear;
  double change_k = 0;                    ///< change from the first group to the last, according to the fit
  Interval change_ci95{};                 ///< in kelvin
  std::optional<double> time_constant_s;  ///< T of an exponential; empty for a straight line
  Interval time_constant_ci95{};          ///< a side that the data do not determine is open
  double p_linear = 1;                    ///< p value of a straight line against an exponential (F test)
  std::vector<double> seen_k, fitted_k;   ///< observed and fitted values of each group
};

/// Drift of a camera after a correction.
struct DriftLaw {
  std::vector<double> time_s;  ///< mean times of the groups
  /// Mean of the picture. The interval includes the random change of the mean due to the change of the pattern:
  /// standard deviation of the change of the pattern, divided by the root of the number of pixels.
  DriftFit level;
  /// Standard deviation over the pixels of the change since the first group, after removal of white noise, mean and
  /// shading of second order. The change is never negative. If the interval begins at 0, no change is proven.
  DriftFit pattern;

  /// Returns a change in kelvin per minute, averaged over the time from the first group to the last.
  [[nodiscard]] double per_minute(double change_k) const;
};

/// Minimum number of groups of drift_law().
inline constexpr std::size_t least_drift_groups = 8;

/// Fits level and pattern as functions of time. Groups are weighted by their number of frames. The level is fitted by
/// least squares. The pattern is fitted by analysis of variance of the pixels' regressions on time, with modified
/// large-sample intervals (Graybill and Wang 1980). The fit begins with a straight line. The line is replaced by an
/// exponential, with the time constant of least squares, if the residuals are then significantly smaller (F test at 1
/// %). With the noise of many pixels, the search for a time constant always finds an exponential that fits slightly
/// better than the line. For the pattern, F is therefore first reduced by 2.5 standard deviations of the improvement
/// due to noise alone. Errors: `invalid_input` (fewer than eight groups, groups without frames, times that do not
/// increase, pictures below 4 x 4 pixels or of different sizes).
[[nodiscard]] Result<DriftLaw> drift_law(std::span<const DriftGroup> groups);

}  // namespace todbench
