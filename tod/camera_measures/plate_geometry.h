// Angle per pixel and distortion from the places of a plate's triangles in a mean picture.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

/// A number with its 95 % interval.
struct GeometryValue {
  double value = 0, low = 0, high = 0;
};

/// Where a triangle was found, and what the fit leaves.
struct GeometryPlace {
  std::string triangle;
  cv::Point2d found_px{0, 0};
  cv::Point2d residual_px{0, 0};  ///< found less fitted
};

/// The picture of a plane behind a lens: a homography (8 parameters), then radial distortion about the middle of the
/// picture, q = c + (p - c)(1 + k r^2 / R^2), R half the picture's diagonal (Brown 1966, first term).
struct PlateGeometry {
  GeometryValue mm_per_px_x, mm_per_px_y;  ///< on the plate along the picture's rows and columns, at the middle of the
                                           ///< plate, without distortion
  GeometryValue rotation_deg;              ///< of the plate in the picture, clockwise
  GeometryValue keystone_x_percent;        ///< by which the scale at the plate's right border is above that at its left
  GeometryValue keystone_y_percent;        ///< at its lower border above that at its upper
  GeometryValue distortion_percent;        ///< k: at the corner of the picture; positive: pincushion
  double residual_px = 0;                  ///< root mean square of a coordinate, over the degrees of freedom
  double farthest_px = 0;                  ///< of a triangle from the middle of the picture
  double corner_px = 0;                    ///< of the corner
  std::vector<GeometryPlace> places;
};

/// Each triangle is located by itself (fit_shift()) near where `where` has it; those that stand out of the noise count,
/// from 1.5 px on. Nine parameters by least squares, each triangle with the noise of its place and 0.004 px that the
/// description of its edges may be off; intervals from the residuals, or from
/// the noise where that says more, Student's t. A triangle that lies six medians off
/// is left out. `calibration` with fewer than ten triangles, or where they do not tell distortion and perspective
/// apart.
[[nodiscard]] Result<PlateGeometry> plate_geometry(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                                   const Registration& where);

}  // namespace todbench
