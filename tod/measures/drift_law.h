// How a camera drifts after a correction of its non-uniformity: growth of the mean and of the spatial noise.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

/// Successive frames of a flat field, averaged.
struct DriftGroup {
  double time_s = 0;  ///< mean, since the correction
  int frames = 0;
  cv::Mat1d mean_k;
};

/// How something grows with time.
enum class DriftShape {
  linear,    ///< t
  approach,  ///< 1 - exp(-t / T)
};
[[nodiscard]] std::string_view to_string(DriftShape shape);

/// A side without a value is open.
struct DriftInterval {
  std::optional<double> low, high;
};

/// One quantity over time.
struct DriftFit {
  DriftShape shape = DriftShape::linear;
  double change_k = 0;                    ///< from the first group to the last, by the fit
  DriftInterval change_ci95{};            ///< in kelvin
  std::optional<double> time_constant_s;  ///< of an approach
  DriftInterval time_constant_ci95{};     ///< open where the data leave it open
  double p_linear = 1;                    ///< of a straight line, against an approach (F test)
  std::vector<double> seen_k, fitted_k;   ///< by group
};

/// Growth after a correction.
struct DriftLaw {
  std::vector<double> time_s;  ///< of the groups
  /// Mean of the picture. These pixels stand for those of the camera: what the mean of so many draws of the pattern is
  /// beside 0 is in the interval.
  DriftFit level;
  /// Standard deviation over the pixels of their change since the first group, without white noise, mean and shading of
  /// second order. Its change is never below 0; an interval that begins at 0 leaves open whether there is any.
  DriftFit pattern;

  /// Of a change, in kelvin per minute: over the time from the first group to the last.
  [[nodiscard]] double per_minute(double change_k) const;
};

inline constexpr std::size_t least_drift_groups = 8;

/// Groups count by their frames. Least squares for the level; for the pattern analysis of variance of the pixels'
/// regressions on time, with modified large sample intervals (Graybill and Wang 1980). An approach is taken where a
/// straight line leaves more than chance explains (F test at 1 %; of the pattern beyond what a search among the noise
/// of its pixels finds), with the time constant of least squares. Errors: `invalid_input` for fewer than eight groups,
/// groups without frames, times that do not rise, or pictures below 4 x 4 pixels or of other sizes.
[[nodiscard]] Result<DriftLaw> drift_law(std::span<const DriftGroup> groups);

}  // namespace todbench
