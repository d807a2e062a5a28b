// SPDX-License-Identifier: GPL-3.0-or-later
// Transmittance of the air between target and camera on the bench, computed from the humidity.
#pragma once

#include "acquisition/base/result.h"
#include "sim_devices/atmosphere/band_radiance.h"

namespace todbench {

/// State of the room.
struct BenchAir {
  double temperature_c = 20;
  double humidity_percent = 50;  ///< relative, over water
};

/// Returns the density of water vapour in g/m3: saturation pressure by the Magnus formula (WMO 2008, annex 4.B), ideal
/// gas.
[[nodiscard]] double absolute_humidity_g_m3(const BenchAir& air);

/// Returns the factor by which `length_m` of air reduces a contrast, from the shipped tables without aerosol. The
/// optical depth of the model atmospheres at this length is interpolated linearly in their absolute humidity and is
/// extrapolated beyond the most humid atmosphere up to 30 g/m3. The band models of the tables are extrapolated to paths
/// of a few metres, so the uncertainty of the loss is large (bench_air_relative_half_width). Errors: `invalid_input`
/// (no band of the tables is near `band`; more than 30 g/m3 of water vapour; a length that is not positive, or longer
/// than the tables).
[[nodiscard]] Result<double> bench_transmittance(const BenchAir& air, double length_m, const SpectralBand& band);

/// Half-width of the uncertainty of the loss 1 - transmittance, as a share of the loss.
inline constexpr double bench_air_relative_half_width = 0.5;

}  // namespace todbench
