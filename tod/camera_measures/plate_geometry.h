// SPDX-License-Identifier: GPL-3.0-or-later
// Angle per pixel and distortion from the locations of a plate's triangles in a mean picture.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "acquisition/base/interval.h"
#include "acquisition/base/result.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

/// Location of a triangle and its residual.
struct GeometryPlace {
  std::string triangle;
  cv::Point2d found_px{0, 0};
  cv::Point2d residual_px{0, 0};  ///< located minus fitted
};

/// Model of the image of a plane: a homography (8 parameters), followed by radial distortion about the middle c of the
/// picture, q = c + (p - c)(1 + k r^2 / R^2). Here r is the distance of p from c, and R is half of the diagonal of the
/// picture (Brown 1966, first term).
struct PlateGeometry {
  /// Scale on the plate along the picture's rows and columns, at the middle of the plate, without distortion.
  Estimate mm_per_px_x, mm_per_px_y;
  /// Point of the plate at the centre of the picture, in mm from the centre of the plate. x is along the rows of the
  /// plate.
  Estimate centre_x_mm, centre_y_mm;
  Estimate rotation_deg;        ///< rotation of the plate in the picture, clockwise
  Estimate keystone_x_percent;  ///< scale at the plate's right border minus scale at its left border, relative
  Estimate keystone_y_percent;  ///< scale at the plate's lower border minus scale at its upper border, relative
  Estimate distortion_percent;  ///< relative distortion at the corner of the picture; positive: pincushion
  double residual_px = 0;       ///< root of the sum of squares of all coordinates / degrees of freedom
  double farthest_px = 0;       ///< largest distance of a triangle from the middle of the picture, in pixels along x
  double corner_px = 0;         ///< distance of the corner from the middle of the picture, in pixels along x
  std::vector<GeometryPlace> places;
};

/// Locates each triangle separately (fit_shift()), starting at the position according to `where`. Uses triangles of at
/// least 1.5 px that exceed the noise. Fits nine parameters by least squares. The error of each position consists of
/// the noise of the position and of 0.004 px for the shift caused by blur and sampling. Intervals are computed from the
/// residuals with Student's t, and from the noise of the triangle positions. The wider interval is used. A triangle
/// with a residual above six times the median is excluded. Errors: `calibration` (fewer than ten triangles, or
/// triangles that do not distinguish distortion from perspective).
[[nodiscard]] Result<PlateGeometry> plate_geometry(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                                   const Registration& where);

}  // namespace todbench
