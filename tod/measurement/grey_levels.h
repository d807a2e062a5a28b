// Contrast of a camera whose counts are no temperatures: grey levels of the large triangles, frame by frame.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>

#include "acquisition/core/result.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

/// What the contrast of the large triangles is measured in.
enum class ContrastUnit {
  kelvin,       ///< of the camera's temperature scale
  grey_levels,  ///< of a camera with gain control; the contrast in kelvin is that of the target, and the large
                ///< triangles of every frame say how many grey levels it is there
};
inline constexpr std::array all_contrast_units{ContrastUnit::kelvin, ContrastUnit::grey_levels};
[[nodiscard]] constexpr std::string_view to_string(ContrastUnit unit) {
  return unit == ContrastUnit::grey_levels ? "grey-levels" : "kelvin";
}
/// How levels are read in this unit: grey levels are few, kelvin are fine.
[[nodiscard]] constexpr LevelEstimate level_estimate(ContrastUnit unit) {
  return unit == ContrastUnit::grey_levels ? LevelEstimate::mean : LevelEstimate::median;
}

/// How far the grey levels of a picture can be told from each other near its surround.
struct GreySteps {
  double noise_levels = 0;  ///< standard deviation of a pixel in a frame, rounding included
  double step_levels = 1;   ///< mean distance of the levels that occur; above 1 where a gain spreads coarser counts
  /// Standard deviation of the noise in steps, as it was before rounding (Sheppard's correction).
  [[nodiscard]] double noise_steps() const;
  /// rounding_variance() of it. Without noise a level between two steps looks as if it had half a step of it: up to
  /// 0.52 measured steps tell nothing, and the variance is that without noise.
  [[nodiscard]] double rounding_variance_steps() const;
};

/// Of the counts that occur in `lowest` and `highest` within three standard deviations of their median.
[[nodiscard]] GreySteps grey_steps(const cv::Mat1w& lowest, const cv::Mat1w& highest, double noise_levels);

/// Variance of the mean of many rounded values, in squared steps, over all places of the true value between two steps:
/// sum over k of exp(-4 pi^2 k^2 s^2) / (2 pi^2 k^2), s the standard deviation of normal noise in steps; 1/12 without
/// noise (Widrow and Kollar 2008, Quantization Noise, 4.3).
[[nodiscard]] double rounding_variance(double noise_steps);

/// Contrast of the large triangles of one frame, in grey levels.
struct GreyContrast {
  double levels = 0;                ///< mean over the triangles
  double standard_uncertainty = 0;  ///< from their scatter, and of rounding, which all of them share
  double degrees_of_freedom = 1;    ///< Welch and Satterthwaite
  int triangles = 0;
  /// Half of the 95 % interval.
  [[nodiscard]] double half_width() const;
};

/// effective_contrast() by means, with the uncertainty of rounding. Errors: those of effective_contrast();
/// `calibration` for a single triangle: its scatter is not known.
[[nodiscard]] Result<GreyContrast> grey_contrast(const cv::Mat1d& levels, const TargetPlate& mounted_plate,
                                                 const Registration& registration, double min_size_px,
                                                 const GreySteps& steps);

/// The contrast of one frame that was judged.
struct GreyFrame {
  std::int64_t presentation = 0;
  std::string plate;
  Mounting mounting = Mounting::identity;
  double set_delta_t_k = 0;
  double delta_t_k = 0;     ///< of the target
  std::uint64_t frame = 0;  ///< sequence number
  GreyContrast contrast;
  double levels_per_k = 0;  ///< signal transfer of this frame, blur of the large triangles allowed for
  double noise_steps = 0;   ///< of a pixel, in steps of the grey levels that occur
  [[nodiscard]] double relative_uncertainty() const {
    return contrast.standard_uncertainty / std::abs(contrast.levels);
  }
};

}  // namespace todbench
