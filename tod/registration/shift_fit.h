// Least-squares location of blurred polygons in a picture: maximum likelihood for white noise, with unknown contrast
// and background.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <vector>

#include "hvs/shape/polygon.h"

namespace todbench {

/// How a picture differs from the polygons that were expected in it.
struct ShiftFit {
  cv::Point2d shift;                     ///< of all polygons together, from where they were given, px
  cv::Point2d standard_error;            ///< from the residuals, px
  std::vector<double> amplitudes;        ///< contrast of each polygon, in the unit of the picture
  std::vector<double> amplitude_errors;  ///< their standard errors
  double residual_rms = 0;               ///< unit of the picture
  double unexplained = 1;         ///< share of the windows' variance (beyond a plane) that the polygons do not explain
  double joint_significance = 0;  ///< common contrast over its standard error; > 0 for warm polygons
};

/// Fits one common shift of `polygons` (pixels), starting at `start`, with a free contrast and a free background plane
/// for each. Each is compared in its bounding box and 3 px round it, so other things should be farther away than that.
/// Nothing when a window leaves the picture, the shift goes farther than `reach_px` from `start`, or the picture is
/// flat.
///
/// Why not the centre of mass: it weighs noise with the distance from the centre (0.14 px for S = 5 px at contrast /
/// noise = 13), the fit only along the edges (0.023 px).
[[nodiscard]] std::optional<ShiftFit> fit_shift(const cv::Mat1d& picture, std::span<const Polygon> polygons,
                                                double blur_px, cv::Point2d start, double reach_px);

/// Sum of squared residuals of the polygons as they stand, with contrast and background planes fitted: smallest at the
/// right blur.
[[nodiscard]] double misfit(const cv::Mat1d& picture, std::span<const Polygon> polygons, double blur_px);

/// Coarse search: the whole-pixel offset, up to `reach_px` in x and y, at which the polygons with one common contrast
/// of either sign explain most of the picture. Nothing when no offset keeps all windows inside the picture.
[[nodiscard]] std::optional<cv::Point> coarse_offset(const cv::Mat1d& picture, std::span<const Polygon> polygons,
                                                     double blur_px, int reach_px);

}  // namespace todbench
