// SPDX-License-Identifier: GPL-3.0-or-later
// The display of the operator as a part of the chain: angle of a displayed sample, luminance, contrast, blur.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// How an enlarged picture fills the display pixels between its samples.
enum class DisplayInterpolation {
  hold,    ///< a sample is a square of zoom x zoom pixels
  linear,  ///< bilinear
};
inline constexpr std::array all_display_interpolations{DisplayInterpolation::hold, DisplayInterpolation::linear};
[[nodiscard]] constexpr std::string_view to_string(DisplayInterpolation interpolation) {
  return interpolation == DisplayInterpolation::linear ? "linear" : "hold";
}

/// A display at a distance. The background of the target is shown in the middle of the luminance range.
struct ViewedDisplay {
  double pixel_pitch_mm = 0;      ///< 0: from diagonal and pixels
  double diagonal_in = 0;         ///< of the picture area, square pixels
  std::vector<double> pixels{};   ///< columns and rows
  double viewing_distance_m = 0;  ///< eye to display
  double luminance_white_cd_m2 = 0;
  double luminance_black_cd_m2 = 0;
  double gamma = 2.2;                     ///< luminance over black goes with level^gamma
  std::vector<double> luminance_table{};  ///< cd/m2 at equal steps of the level, in place of white, black and gamma
  double veil_cd_m2 = 0;                  ///< ambient light that the display reflects, added to every luminance
  double zoom = 1;                        ///< display pixels per displayed sample, along an axis
  DisplayInterpolation interpolation = DisplayInterpolation::hold;
  double spot_mm = 0;     ///< standard deviation of a Gaussian spot (CRT); 0: sharp pixels (LCD)
  double contrast = 0.5;  ///< luminance contrast at which the operator shows every target; unused with span_k
  double span_k = 0;      ///< kelvin from black to white at a fixed gain; 0: the operator sets the gain
  bool operator==(const ViewedDisplay&) const = default;
};

/// Checks a display. `invalid_input`: one sentence with the key, e.g. a distance in mm, a luminance of 0, a table that
/// falls, a contrast that cannot be shown.
[[nodiscard]] Result<void> validate(const ViewedDisplay& display);

/// Distance of two display pixels in mm. Precondition of this and of all following functions: validate() succeeds.
[[nodiscard]] double pixel_pitch_mm(const ViewedDisplay& display);
/// Luminance at a level from 0 to 1, without veil.
[[nodiscard]] double luminance_cd_m2(const ViewedDisplay& display, double level);
/// Angle of a displayed sample at the eye, in arcmin.
[[nodiscard]] double arcmin_per_sample(const ViewedDisplay& display);
/// Luminance of the background, which the eye adapts to, in cd/m2: the middle of the range, veil included.
[[nodiscard]] double adaptation_luminance_cd_m2(const ViewedDisplay& display);
/// Largest luminance contrast (target minus background over background) that can be shown in both directions.
[[nodiscard]] double largest_contrast(const ViewedDisplay& display);
/// Luminance contrast of a target of `delta_t_k` kelvin, without sign. With a fixed gain it is the mean of a hot and a
/// cold target. `invalid_input` if the display cannot show it.
[[nodiscard]] Result<double> luminance_contrast(const ViewedDisplay& display, double delta_t_k);
/// Same for any contrast: a contrast that cannot be shown is replaced by the largest that can.
[[nodiscard]] double shown_contrast(const ViewedDisplay& display, double delta_t_k);
/// Transfer of the display at (u, w) cycles per displayed sample: hold or interpolation, and spot. Real and even.
[[nodiscard]] double display_transfer(const ViewedDisplay& display, double u, double w);
/// A sentence if a displayed sample is so small (below 2 arcmin) that the eye limits a test; empty otherwise.
[[nodiscard]] std::optional<std::string> small_sample_warning(const ViewedDisplay& display);

}  // namespace todbench
