// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison of the mean picture of the plate with the picture of a sensor model at the same position.
#pragma once

#include "acquisition/base/result.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {

/// Computes the model's noise-free picture of the plate at the observed position, scale and rotation. Contrast, level
/// and the residuals of position, scale and rotation are fitted by least squares. Errors: `invalid_input` (the model
/// and the camera differ in the number of pixels, or the contrast cannot be fitted).
[[nodiscard]] Result<PlatePicture> plate_picture(const PlateView& seen, const TargetPlate& plate,
                                                 const SensorModel& model, SceneMotion motion);

}  // namespace todbench
