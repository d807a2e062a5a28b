// SPDX-License-Identifier: GPL-3.0-or-later
// Air path between target and camera, by name or from a file.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "sim_devices/atmosphere/band_radiance.h"
#include "tod/range/transmittance.h"

namespace todbench {

/// Inputs of an air path besides its name.
struct AtmosphereRequest {
  SpectralBand band{};                ///< band of the camera
  std::string haze = "rural-23km";    ///< one of haze_names(); shipped table only
  double weight_temperature_k = 300;  ///< temperature of the weight dL/dT, for air given as a spectrum
  double extinction_per_km = 0;       ///< extinction coefficient for "beer-lambert"; otherwise not used
};

/// Air path of a range prediction, with its origin.
struct Atmosphere {
  std::string name;    ///< as requested
  std::string source;  ///< a sentence: program, table, aerosol, band and weight; or the file
  Transmittance air = Transmittance::beer_lambert(0);
  std::optional<double> air_k{};             ///< air temperature of the model atmosphere at the ground
  std::optional<SpectralBand> table_band{};  ///< band of the shipped table that was used; empty for other air
  std::vector<std::string> notes{};
};

/// Returns "clear", "beer-lambert" and the model atmospheres of the shipped table: "us-standard", "tropical" ...
[[nodiscard]] std::vector<std::string> atmosphere_names();
/// Returns the aerosols of the shipped table: "none", "rural-23km" ...
[[nodiscard]] std::vector<std::string> haze_names();

/// Loads an air path by name or from a file (a reference with a slash or a dot). A CSV file has a header with range_km
/// or range_m, and transmittance or tau; or wavelength_um and extinction_per_km. Any other file extension is read as
/// tape7 of MODTRAN. The shipped table supplies its band that is nearest to the camera's band, if both limits of the
/// bands agree within 0.6 um. Errors: `invalid_input` with the file and, if known, the line; also if the request states
/// an extinction for air that already defines one.
[[nodiscard]] Result<Atmosphere> load_atmosphere(std::string_view reference, const AtmosphereRequest& request);

/// Parses the text of a file; the name of the file selects the format. Errors: as load_atmosphere().
[[nodiscard]] Result<Atmosphere> parse_atmosphere(std::string_view text, const std::string& file,
                                                  const AtmosphereRequest& request);

}  // namespace todbench
