// From spectra to band transmittance: extinction by wavelength, and MODTRAN's tape7.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "sim_devices/atmosphere/band_radiance.h"
#include "tod/range/transmittance.h"

namespace todbench {

struct SpectralExtinction {
  double wavelength_um = 0;      ///< > 0, increasing
  double extinction_per_km = 0;  ///< >= 0
};
/// Band transmittance at every range, with weight dL/dT (power) of a black body and the trapezoid rule over the listed
/// wavelengths. `invalid_input` in one sentence.
[[nodiscard]] Result<Transmittance> air_of_spectrum(std::span<const SpectralExtinction> spectrum, double temperature_k);

/// One run of a tape7 file.
struct Tape7Run {
  double range_km = 0;  ///< of card 3
  std::vector<double> wavenumber_per_cm, transmittance;
};
/// The runs of a file of MODTRAN 4 or 5, or LOWTRAN 7: card 3 follows the line with the name of the model atmosphere
/// and has the range in columns 31 to 40; the first column behind the header FREQ is the wavenumber (cm-1), the second
/// the total transmittance; -9999 ends a run. `invalid_input` "line N: ...".
[[nodiscard]] Result<std::vector<Tape7Run>> parse_tape7(std::string_view text);

/// Mean over the band with weight dL/dT (trapezoid in wavenumber). `invalid_input` where the run does not cover the
/// band.
[[nodiscard]] Result<double> band_transmittance(const Tape7Run& run, const SpectralBand& band, double temperature_k);
/// Several runs: a table over their ranges. One run: Beer and Lambert at each of its wavenumbers, tabulated from 1/1000
/// of its range up to it; that treats lines narrower than the resolution as grey. `invalid_input` as above.
[[nodiscard]] Result<Transmittance> air_of_tape7(std::span<const Tape7Run> runs, const SpectralBand& band,
                                                 double temperature_k);

}  // namespace todbench
