// Diffraction over the wavelengths of the band; without it, at their mean alone.
#include "sim_devices/sensor/effect_row.h"

namespace todbench {

EffectRow effect_rows::spectral_band() {
  EffectRow row;
  row.title = "Spectral band";
  row.keys = {{"wavelength_min_um", &SensorSpec::wavelength_min_um, NumberRange::positive(), KeyPresence::required,
               "where the band begins"},
              {"wavelength_max_um", &SensorSpec::wavelength_max_um, NumberRange::positive(), KeyPresence::required,
               "where the band ends"}};
  row.impossible = [](const SensorSpec& spec) -> std::string {
    return spec.wavelength_max_um > spec.wavelength_min_um ? "" : "wavelength_min_um must be below wavelength_max_um";
  };
  row.stage = stage::Parameter{};
  row.bound = [](const ExpectedScene& scene) -> std::optional<double> {
    return 2 * scene.discriminability_change(Effect::spectral_band);
  };
  return row;
}

}  // namespace todbench
