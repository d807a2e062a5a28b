// SPDX-License-Identifier: GPL-3.0-or-later
// Response of the estimator of effective contrast to a known contrast, blur included.
#pragma once

#include <stop_token>

#include "acquisition/base/result.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/registration/registration.h"

namespace todbench {

/// Returns the mean of effective_contrast() over the four mountings and several sampling phases of noise-free pictures
/// at a contrast of 1 K. The response is just below 1, because blur reaches the inside of small triangles. Errors:
/// those of register_plate() and effective_contrast(); `interrupted` within one picture of a stop request.
[[nodiscard]] Result<double> contrast_response(const SensorModel& model, const TargetPlate& plate, double distance_m,
                                               double min_reference_px, const RegistrationOptions& registration,
                                               std::stop_token stop = {}, LevelEstimate level = LevelEstimate::median);

}  // namespace todbench
