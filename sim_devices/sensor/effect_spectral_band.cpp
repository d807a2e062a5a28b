// SPDX-License-Identifier: GPL-3.0-or-later
// Spectral band: diffraction averaged over the wavelengths. Without the effect it is computed at their mean.
#include "sim_devices/sensor/effect_row.h"

namespace todbench {

EffectRow effect_rows::spectral_band() {
  EffectRow row;
  row.title = "Spectral band";
  row.keys = {{"wavelength_min_um", &SensorSpec::wavelength_min_um, NumberRange::between(0.1, 100),
               KeyPresence::required, "lower end of the band"},
              {"wavelength_max_um", &SensorSpec::wavelength_max_um, NumberRange::between(0.1, 100),
               KeyPresence::required, "upper end of the band"}};
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
