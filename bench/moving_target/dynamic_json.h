// SPDX-License-Identifier: GPL-3.0-or-later
// Dynamic TOD as JSON, for standard output and sessions.
#pragma once

#include "bench/moving_target/dynamic_measurement.h"
#include "bench/session/json_output.h"

namespace todbench {

/// Returns the acuities by speed and observer.
[[nodiscard]] Json speeds_json(const std::vector<DynamicAcuity>& found);
/// Returns a measurement as JSON: the request, the acuities at every contrast, the time constant, and every pass.
[[nodiscard]] Json dynamic_measurement_json(const DynamicMeasurement& found, const Plan& plan);

}  // namespace todbench
