// The air between target and camera, by name or from a file.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "sim_devices/atmosphere/band_radiance.h"
#include "tod/range/transmittance.h"

namespace todbench {

/// What is asked of the air beside its name.
struct AtmosphereRequest {
  SpectralBand band{};                ///< of the camera
  std::string haze = "rural-23km";    ///< one of haze_names(); for the shipped table
  double weight_temperature_k = 300;  ///< of the weight dL/dT, for spectra
  double extinction_per_km = 0;       ///< of "beer-lambert"
};

struct Atmosphere {
  std::string name;    ///< as it was asked for
  std::string source;  ///< program, table, aerosol, band and weight; or the file: a sentence
  Transmittance air = Transmittance::beer_lambert(0);
  std::optional<double> air_k{};  ///< of the model atmosphere at the ground
  std::optional<SpectralBand> table_band{};
  std::vector<std::string> notes{};
};

/// "clear", "beer-lambert", and the model atmospheres of the shipped table: "us-standard", "tropical", ...
[[nodiscard]] std::vector<std::string> atmosphere_names();
/// Aerosols of the shipped table: "none", "rural-23km", ...
[[nodiscard]] std::vector<std::string> haze_names();

/// A name, or a file: a reference with a slash or a dot. A CSV file has a header with range_km or range_m, and
/// transmittance or tau; or wavelength_um and extinction_per_km. Any other ending is read as MODTRAN's tape7. Of the
/// shipped table the band nearest to that of the camera is taken where both ends are within 0.6 um.
/// `invalid_input` in one sentence with the file, and the line where there is one; also where an extinction is asked
/// for beside air that has its own.
[[nodiscard]] Result<Atmosphere> load_atmosphere(std::string_view reference, const AtmosphereRequest& request);

/// A file's text; its name says how it is read. Errors: as load_atmosphere().
[[nodiscard]] Result<Atmosphere> parse_atmosphere(std::string_view text, const std::string& file,
                                                  const AtmosphereRequest& request);

}  // namespace todbench
