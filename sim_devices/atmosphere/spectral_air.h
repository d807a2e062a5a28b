// SPDX-License-Identifier: GPL-3.0-or-later
// Band transmittance from spectra: extinction by wavelength, or tape7 of MODTRAN.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "sim_devices/atmosphere/band_radiance.h"
#include "tod/range/transmittance.h"

namespace todbench {

/// Extinction at one wavelength.
struct SpectralExtinction {
  double wavelength_um = 0;      ///< > 0, increasing
  double extinction_per_km = 0;  ///< >= 0
};
/// Returns the band transmittance at every range, weighted with dL/dT of a black body (power units) at `temperature_k`,
/// by the trapezoid rule over the listed wavelengths. Errors: `invalid_input`.
[[nodiscard]] Result<Transmittance> air_of_spectrum(std::span<const SpectralExtinction> spectrum, double temperature_k);

/// One run of a tape7 file.
struct Tape7Run {
  double range_km = 0;  ///< from card 3
  std::vector<double> wavenumber_per_cm, transmittance;
};
/// Reads the runs of a file of MODTRAN 4 or 5, or of LOWTRAN 7. Card 3 follows the line with the name of the model
/// atmosphere and has the range in columns 31 to 40. Below the header FREQ the first column is the wavenumber (cm-1),
/// the second the total transmittance. -9999 ends a run. Errors: `invalid_input` "line N: ...".
[[nodiscard]] Result<std::vector<Tape7Run>> parse_tape7(std::string_view text);

/// Returns the mean transmittance over the band, weighted with dL/dT at `temperature_k` (trapezoid rule in wavenumber).
/// Errors: `invalid_input` if the run does not cover the band.
[[nodiscard]] Result<double> band_transmittance(const Tape7Run& run, const SpectralBand& band, double temperature_k);
/// Returns the air of several runs as a table over their ranges. A single run is scaled by the law of Beer and Lambert
/// at each wavenumber and tabulated from 1/1000 of its range to its range. This scaling treats lines narrower than the
/// resolution as grey. Errors: those of band_transmittance().
[[nodiscard]] Result<Transmittance> air_of_tape7(std::span<const Tape7Run> runs, const SpectralBand& band,
                                                 double temperature_k);

}  // namespace todbench
