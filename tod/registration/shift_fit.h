// SPDX-License-Identifier: GPL-3.0-or-later
// Least-squares location of blurred polygons in a picture: maximum likelihood for white noise, with unknown contrast
// and background.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <vector>

#include "hvs/shape/polygon.h"

namespace todbench {

/// Difference between a picture and the expected polygons.
struct ShiftFit {
  cv::Point2d shift;                     ///< common shift of all polygons from their given positions, px
  cv::Point2d standard_error;            ///< standard error of the shift, from the residuals, px
  std::vector<double> amplitudes;        ///< contrast of each polygon, in the unit of the picture
  std::vector<double> amplitude_errors;  ///< standard errors of the amplitudes
  double residual_rms = 0;               ///< unit of the picture
  /// Share of the variance in the windows that the polygons do not explain, after removal of a plane.
  double unexplained = 1;
  double joint_significance = 0;  ///< common contrast divided by its standard error; > 0 for warm polygons
};

/// Fits one common shift of `polygons` (in pixels), starting at `start`. The contrast and the background plane are
/// fitted for each polygon. The window of a polygon is its bounding box and 3 px round it; other objects should be
/// outside this window. Empty if a window is partly outside the picture, the shift differs from `start` by more than
/// `reach_px`, or the picture is flat.
///
/// The fit is more precise than the centre of mass. For S = 5 px and contrast / noise = 13, the error is 0.023 px for
/// the fit and 0.14 px for the centre of mass. Only noise along the edges affects the fit; in a centre of mass, the
/// weight of noise increases with the distance from the centre.
[[nodiscard]] std::optional<ShiftFit> fit_shift(const cv::Mat1d& picture, std::span<const Polygon> polygons,
                                                double blur_px, cv::Point2d start, double reach_px);

/// Displacement of polygons with a common contrast from their given positions, to first order.
struct PlaceFit {
  double amplitude = 0, amplitude_error = 0;  ///< common contrast, in the unit of the picture
  cv::Point2d shift, standard_error;          ///< common shift of all polygons, px
  double turn_rad = 0, turn_error_rad = 0;    ///< rotation about `centre`, clockwise in the picture; 0 for fewer than 3
                                              ///< polygons
  double residual_rms = 0;                    ///< unit of the picture
};

/// Computes one Gauss-Newton step from the given positions. The step is a linear function of the picture. The result is
/// therefore unbiased and has a known error, even if no single polygon is visible above the noise. A shift above half a
/// pixel is underestimated. Each standard error is the largest of three estimates: for independent pixels, for noise
/// common to rows, and for noise common to columns (sandwich estimates). Empty if a window is partly outside the
/// picture, or if the polygons do not determine a shift.
[[nodiscard]] std::optional<PlaceFit> fit_place(const cv::Mat1d& picture, std::span<const Polygon> polygons,
                                                double blur_px, cv::Point2d centre);

/// Returns the window of a polygon in fit_place().
[[nodiscard]] cv::Rect place_window(const Polygon& polygon);

/// Returns the sum of squared residuals of the polygons at their positions, with contrast and background planes fitted.
/// The sum is smallest at the correct blur.
[[nodiscard]] double misfit(const cv::Mat1d& picture, std::span<const Polygon> polygons, double blur_px);

/// Performs a coarse search. Returns the offset in whole pixels, up to `reach_px` in x and y, at which polygons with
/// one common contrast of either sign explain the largest part of the picture. Empty if no offset keeps all windows
/// inside the picture.
[[nodiscard]] std::optional<cv::Point> coarse_offset(const cv::Mat1d& picture, std::span<const Polygon> polygons,
                                                     double blur_px, int reach_px);

}  // namespace todbench
