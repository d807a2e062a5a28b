// SPDX-License-Identifier: GPL-3.0-or-later
// Response of the contrast estimator for the plates of a plan, from the simulated sensor.
#pragma once

#include <map>
#include <stop_token>
#include <string>
#include <vector>

#include "bench/plan/plan.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/measurement/measurement.h"

namespace todbench {

/// Returns the response of the contrast estimator to 1 K on each plate, by name, with the simulated sensor in place of
/// the camera. Errors: those of contrast_response().
[[nodiscard]] Result<std::map<std::string, double>> simulated_responses(const SensorModel& model, const Plan& plan,
                                                                        const std::vector<TargetPlate>& plates,
                                                                        const MeasurementOptions& options,
                                                                        std::stop_token stop);

}  // namespace todbench
