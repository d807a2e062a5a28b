// SPDX-License-Identifier: GPL-3.0-or-later
// Change of a camera's line of sight between two measurements of one plate.
#pragma once

#include "acquisition/base/result.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {

/// Change from the first to the second measurement, for example between zoom states or because of remounting. The line
/// of sight is the direction of the middle of the picture.
struct Boresight {
  /// Shift along the rows and columns of the first picture; right and down are positive.
  Estimate shift_x_mrad, shift_y_mrad;
  Estimate shift_x_px, shift_y_px;  ///< this shift in pixels of the first picture
  Estimate roll_mrad;  ///< rotation of the camera about its line of sight, clockwise in the viewing direction
  double distance_m = 0;
  double ifov_ratio = 1;  ///< measured IFOV of the second measurement divided by that of the first
  /// Error of the shift in mrad per millimetre of sideways translation of the camera.
  double sideways_mrad_per_mm = 0;
};

/// Computes the change from the positions of the plate in both measurements. Each interval combines the errors of both
/// positions and, if the budget states it, the error of the distance. Precondition: between the measurements the plate
/// did not move, and the entrance pupil did not move sideways. Errors: `invalid_input` (different plates, distances or
/// picture sizes; measured IFOVs that contradict the stated IFOVs, because distance or zoom state is wrong; a picture
/// centre outside the area of the triangles; a record without a line of sight).
[[nodiscard]] Result<Boresight> boresight(const GeometryMeasure& first, const GeometryMeasure& second);

}  // namespace todbench
