// SPDX-License-Identifier: GPL-3.0-or-later
// Contrast of a camera whose counts are not temperatures: grey levels of the large triangles in each frame.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>

#include "acquisition/base/result.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

/// Unit in which the contrast of the large triangles is measured.
enum class ContrastUnit {
  kelvin,  ///< kelvin of the camera's temperature scale
  /// Unit for a camera with gain control. The target reports the contrast in kelvin, and the contrast in grey levels is
  /// measured at the large triangles of every frame.
  grey_levels,
};
inline constexpr std::array all_contrast_units{ContrastUnit::kelvin, ContrastUnit::grey_levels};
[[nodiscard]] constexpr std::string_view to_string(ContrastUnit unit) {
  return unit == ContrastUnit::grey_levels ? "grey-levels" : "kelvin";
}
/// Returns the estimator of levels for this unit: the mean for grey levels, because grey levels have coarse steps; the
/// median for kelvin.
[[nodiscard]] constexpr LevelEstimate level_estimate(ContrastUnit unit) {
  return unit == ContrastUnit::grey_levels ? LevelEstimate::mean : LevelEstimate::median;
}

/// Resolution of the grey levels of a picture near its surround.
struct GreySteps {
  double noise_levels = 0;  ///< standard deviation of a pixel in a frame, rounding included
  /// Mean distance between the levels that occur; above 1 if a gain multiplies coarse counts.
  double step_levels = 1;
  /// Returns the standard deviation of the noise before rounding, in steps (Sheppard's correction).
  [[nodiscard]] double noise_steps() const;
  /// Returns rounding_variance() of this noise. Measured noise of up to 0.52 steps is treated as zero, because a level
  /// between two steps causes a measured noise of up to half a step even without noise.
  [[nodiscard]] double rounding_variance_steps() const;
};

/// Returns the resolution of the counts within three standard deviations of the median. `lowest`, `highest`: smallest
/// and largest count of each pixel. If only one count occurs in this range despite noise, the step is the distance to
/// the next count that occurs.
[[nodiscard]] GreySteps grey_steps(const cv::Mat1w& lowest, const cv::Mat1w& highest, double noise_levels);

/// Returns the variance of the mean of many rounded values, in squared steps, averaged over all positions of the true
/// value between two steps. It is the sum over k >= 1 of exp(-4 pi^2 k^2 s^2) / (2 pi^2 k^2), where s is the standard
/// deviation of normal noise in steps. Without noise it is 1/12 (Widrow and Kollar 2008, Quantization Noise, 4.3).
[[nodiscard]] double rounding_variance(double noise_steps);

/// Contrast of the large triangles of one frame, in grey levels.
struct GreyContrast {
  double levels = 0;  ///< mean over the triangles
  /// Standard uncertainty from the scatter over the triangles, and from rounding, whose error is common to all
  /// triangles.
  double standard_uncertainty = 0;
  double degrees_of_freedom = 1;  ///< Welch and Satterthwaite
  int triangles = 0;
  /// Returns the half-width of the 95 % interval, in grey levels.
  [[nodiscard]] double half_width() const;
};

/// Measures the contrast by effective_contrast() with mean levels, and adds the uncertainty of rounding. Errors: those
/// of effective_contrast(); `calibration` if there is only one triangle, because the scatter is then not known.
[[nodiscard]] Result<GreyContrast> grey_contrast(const cv::Mat1d& levels, const TargetPlate& mounted_plate,
                                                 const Registration& registration, double min_size_px,
                                                 const GreySteps& steps);

/// Contrast of one judged frame.
struct GreyFrame {
  std::int64_t presentation = 0;
  std::string plate;
  Mounting mounting = Mounting::identity;
  double set_delta_t_k = 0;
  double delta_t_k = 0;     ///< reported by the target
  std::uint64_t frame = 0;  ///< sequence number
  GreyContrast contrast;
  double levels_per_k = 0;  ///< signal transfer of this frame, corrected for the blur of the large triangles
  double noise_steps = 0;   ///< noise of a pixel, in steps of the occurring grey levels
  [[nodiscard]] double relative_uncertainty() const {
    return contrast.standard_uncertainty / std::abs(contrast.levels);
  }
};

}  // namespace todbench
