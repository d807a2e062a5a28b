// SPDX-License-Identifier: GPL-3.0-or-later
// Display of the operator: angle of a displayed sample, luminance, contrast and blur.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// Interpolation that fills the display pixels between the samples of an enlarged picture.
enum class DisplayInterpolation {
  hold,    ///< a sample is a square of zoom x zoom pixels
  linear,  ///< bilinear interpolation between the samples
};
inline constexpr std::array all_display_interpolations{DisplayInterpolation::hold, DisplayInterpolation::linear};
[[nodiscard]] constexpr std::string_view to_string(DisplayInterpolation interpolation) {
  return interpolation == DisplayInterpolation::linear ? "linear" : "hold";
}

/// A display at a viewing distance. The background of the target is shown in the middle of the luminance range.
struct ViewedDisplay {
  double pixel_pitch_mm = 0;      ///< 0: computed from diagonal and pixels
  double diagonal_in = 0;         ///< diagonal of the picture area in inches; the pixels are square
  std::vector<double> pixels{};   ///< number of columns and number of rows
  double viewing_distance_m = 0;  ///< eye to display
  double luminance_white_cd_m2 = 0;
  double luminance_black_cd_m2 = 0;
  double gamma = 2.2;                     ///< luminance above black is proportional to level^gamma
  std::vector<double> luminance_table{};  ///< cd/m2 at equal steps of the level; replaces white, black and gamma
  double veil_cd_m2 = 0;                  ///< ambient light that the display reflects, added to every luminance
  double zoom = 1;                        ///< display pixels per displayed sample, along an axis
  DisplayInterpolation interpolation = DisplayInterpolation::hold;
  double spot_mm = 0;     ///< standard deviation of a Gaussian spot (CRT); 0: sharp pixels (LCD)
  double contrast = 0.5;  ///< luminance contrast to which the operator sets every target; unused with span_k
  double span_k = 0;      ///< kelvin from black to white at a fixed gain; 0: the operator sets the gain
  bool operator==(const ViewedDisplay&) const = default;
};

/// Checks a display. Error: `invalid_input` with the key (for example a distance in mm, a luminance of 0, a decreasing
/// table, or a contrast that cannot be shown).
[[nodiscard]] Result<void> validate(const ViewedDisplay& display);

/// Returns the distance between the centres of neighbouring display pixels, in mm. Precondition of this function and of
/// all following functions: validate() succeeds.
[[nodiscard]] double pixel_pitch_mm(const ViewedDisplay& display);
/// Returns the luminance at a level from 0 to 1, without veil.
[[nodiscard]] double luminance_cd_m2(const ViewedDisplay& display, double level);
/// Returns the angle of a displayed sample at the eye, in arcmin.
[[nodiscard]] double arcmin_per_sample(const ViewedDisplay& display);
/// Returns the luminance of the background, to which the eye adapts, in cd/m2. It is the middle of the luminance range
/// plus the veil.
[[nodiscard]] double adaptation_luminance_cd_m2(const ViewedDisplay& display);
/// Returns the largest luminance contrast (target minus background, divided by background) that can be shown with both
/// signs.
[[nodiscard]] double largest_contrast(const ViewedDisplay& display);
/// Returns the luminance contrast of a target of `delta_t_k` kelvin, without sign. With a fixed gain it is the mean of
/// the contrasts of a hot and a cold target. Error: `invalid_input` if the display cannot show this contrast.
[[nodiscard]] Result<double> luminance_contrast(const ViewedDisplay& display, double delta_t_k);
/// Returns luminance_contrast(), or the largest contrast that can be shown if the contrast exceeds it.
[[nodiscard]] double shown_contrast(const ViewedDisplay& display, double delta_t_k);
/// Returns the transfer function of the display at (u, w) cycles per displayed sample. It includes interpolation and
/// spot, and is real and even.
[[nodiscard]] double display_transfer(const ViewedDisplay& display, double u, double w);
/// Returns a warning if a displayed sample is smaller than 2 arcmin, because the eye then limits the result of the
/// test. Otherwise empty.
[[nodiscard]] std::optional<std::string> small_sample_warning(const ViewedDisplay& display);

}  // namespace todbench
