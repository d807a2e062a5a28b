// How the contrast estimate reads the plates of a plan through its simulated sensor.
#pragma once

#include <map>
#include <stop_token>
#include <string>
#include <vector>

#include "bench/plan/plan.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/measurement/measurement.h"

namespace todbench {

/// What the contrast estimate reads of 1 K on each plate, by name; the simulated sensor stands for the camera. Errors
/// as contrast_response().
[[nodiscard]] Result<std::map<std::string, double>> simulated_responses(const SensorModel& model, const Plan& plan,
                                                                        const std::vector<TargetPlate>& plates,
                                                                        const MeasurementOptions& options,
                                                                        std::stop_token stop);

}  // namespace todbench
