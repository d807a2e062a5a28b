// The mean picture of the plate beside that of a sensor model at the same place.
#pragma once

#include "acquisition/core/result.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {

/// The picture that the model makes of the plate without noise, at the place, scale and rotation at which it was found;
/// contrast, level and what is left of place, scale and rotation are fitted by least squares. `invalid_input` where the
/// model has another number of pixels than the camera, or the contrast cannot be fitted.
[[nodiscard]] Result<PlatePicture> plate_picture(const PlateView& seen, const TargetPlate& plate,
                                                 const SensorModel& model, SceneMotion motion);

}  // namespace todbench
