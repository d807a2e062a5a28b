// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/atmosphere/radiative_path.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "acquisition/base/try.h"

namespace todbench {

Result<void> validate(const RadiativeScene& scene) {
  const auto temperature = [](std::string_view whose, double kelvin) -> Result<void> {
    if (std::isfinite(kelvin) && kelvin > 0) return {};
    return fail(ErrorCode::invalid_input,
                fmt::format("the temperature of the {} must be above 0 K, found {:g} K", whose, kelvin));
  };
  TODBENCH_TRY_VOID(temperature("target", scene.target_k));
  TODBENCH_TRY_VOID(temperature("background", scene.background_k));
  TODBENCH_TRY_VOID(temperature("surround", scene.surround_k));
  TODBENCH_TRY_VOID(temperature("air", scene.air_k));
  if (scene.emissivity > 0 && scene.emissivity <= 1) return {};
  return fail(ErrorCode::invalid_input,
              fmt::format("the emissivity must be above 0 and at most 1, found {:g}", scene.emissivity));
}

double radiance_contrast(const SpectralBand& band, const RadiativeScene& scene) {
  return scene.emissivity * (band_radiance(band, scene.target_k) - band_radiance(band, scene.background_k));
}

double equivalent_contrast_k(const SpectralBand& band, double radiance_contrast_w_m2_sr, double calibration_k) {
  return radiance_contrast_w_m2_sr / band_radiance_derivative(band, calibration_k);
}

double path_radiance(const SpectralBand& band, double air_k, double transmittance) {
  return (1 - transmittance) * band_radiance(band, air_k);
}

std::optional<ApparentTemperatures> apparent_temperatures(const SpectralBand& band, const RadiativeScene& scene,
                                                          double transmittance) {
  const double path = path_radiance(band, scene.air_k, transmittance);
  const double reflected = (1 - scene.emissivity) * band_radiance(band, scene.surround_k);
  const auto shown = [&](double kelvin) {
    const double left = scene.emissivity * band_radiance(band, kelvin) + reflected;
    return radiation_temperature_k(band, transmittance * left + path);
  };
  const auto target = shown(scene.target_k), background = shown(scene.background_k);
  if (!target || !background) return std::nullopt;
  return ApparentTemperatures{*target, *background};
}

}  // namespace todbench
