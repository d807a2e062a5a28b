// Dynamic TOD as JSON: on standard output and in a session.
#pragma once

#include "bench/enhance/dynamic_measurement.h"
#include "bench/session/json_output.h"

namespace todbench {

/// Acuities by speed and observer.
[[nodiscard]] Json speeds_json(const std::vector<DynamicAcuity>& found);
/// A measurement: what was asked for, acuities at every contrast, the time constant, every pass.
[[nodiscard]] Json dynamic_measurement_json(const DynamicMeasurement& found, const Plan& plan);

}  // namespace todbench
