// SPDX-License-Identifier: GPL-3.0-or-later
// Turbulence of the air between target and camera, averaged over time.
#pragma once

#include <optional>

#include "sim_devices/atmosphere/turbulence.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Returns the turbulent path of this sensor, at the mean wavelength of its band. Over the band from 7.5 to 13 um the
/// exponent varies by 9 % in each direction, which is less than the uncertainty of Cn2. Empty without turbulence.
[[nodiscard]] std::optional<TurbulentPath> turbulent_path(const SensorSpec& spec);

/// Returns the coefficient c of the transfer function exp(-c rho^(5/3)), rho in cycles per pitch; 0 without turbulence.
[[nodiscard]] double turbulence_strength(const SensorSpec& spec);

/// Returns the bound on the change of ln S75 if turbulence is left out, for triangles of `s75_pitch`: the bound for a
/// Gaussian blur with the same transfer function at half a cycle per triangle size.
[[nodiscard]] double turbulence_bound(const SensorSpec& spec, double s75_pitch);

}  // namespace todbench
