// SPDX-License-Identifier: GPL-3.0-or-later
// Change of a camera's line of sight between two measurements of one plate.
#pragma once

#include "acquisition/base/result.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {

/// Change from the first to the second measurement: zoom states, or before and after remounting. The line of sight is
/// the direction of the middle of the picture.
struct Boresight {
  /// Along the rows and columns of the first picture, right and down positive.
  Estimate shift_x_mrad, shift_y_mrad;
  Estimate shift_x_px, shift_y_px;  ///< the same in pixels of the first picture
  Estimate roll_mrad;               ///< rotation of the camera about its line of sight, clockwise as the camera looks
  double distance_m = 0;
  double ifov_ratio = 1;            ///< of the second measurement over the first, measured
  double sideways_mrad_per_mm = 0;  ///< error by a sideways move of the camera that is no rotation
};

/// Computes the change from the located plate of both measurements. Each interval joins the errors of both located
/// plates and, if the budget states it, that of the distance. It assumes that the plate did not move between the
/// measurements and that the entrance pupil did not move sideways. Errors: `invalid_input` with a sentence: other
/// plate, distance or picture size; measured IFOV that contradict the stated ones, so that distance or zoom state is
/// wrong; a middle of the picture beyond the plate's triangles; a record without a line of sight.
[[nodiscard]] Result<Boresight> boresight(const GeometryMeasure& first, const GeometryMeasure& second);

}  // namespace todbench
