// Turbulence of the air between target and camera, averaged over time.
#pragma once

#include <optional>

#include "sim_devices/atmosphere/turbulence.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// The path before this sensor, at the mean wavelength of its band: over 7.5 to 13 um the exponent changes by 9 %
/// either way, less than Cn2 is ever known. Nothing where there is no turbulence.
[[nodiscard]] std::optional<TurbulentPath> turbulent_path(const SensorSpec& spec);

/// c of the transfer function exp(-c rho^(5/3)), rho in cycles per pitch; 0 without turbulence.
[[nodiscard]] double turbulence_strength(const SensorSpec& spec);

/// A bound on the change of ln S75 that leaving turbulence out makes, at triangles of `s75_pitch`: that of a Gaussian
/// blur as strong at half a cycle per triangle.
[[nodiscard]] double turbulence_bound(const SensorSpec& spec, double s75_pitch);

}  // namespace todbench
