// The air between target and camera on the bench: what its humidity leaves of a contrast.
#pragma once

#include "acquisition/core/result.h"
#include "sim_devices/atmosphere/band_radiance.h"

namespace todbench {

/// The room, as an instrument on the wall says.
struct BenchAir {
  double temperature_c = 20;
  double humidity_percent = 50;  ///< relative, over water
};

/// Grams of water vapour in a cubic metre: saturation pressure after Magnus (WMO 2008, annex 4.B), ideal gas.
[[nodiscard]] double absolute_humidity_g_m3(const BenchAir& air);

/// Of a contrast over `length_m`, by the shipped tables without aerosol: the optical depth of the model atmospheres at
/// this length is taken as linear in their absolute humidity between them and beyond the most humid, up to 30 g/m3.
/// Band models at metres are extrapolated: half of what is lost is uncertain (bench_air_relative_half_width).
/// `invalid_input`: no band of the tables is near, more water than 30 g/m3, a length that is not above 0 or beyond the
/// tables.
[[nodiscard]] Result<double> bench_transmittance(const BenchAir& air, double length_m, const SpectralBand& band);

/// Of 1 - transmittance.
inline constexpr double bench_air_relative_half_width = 0.5;

}  // namespace todbench
