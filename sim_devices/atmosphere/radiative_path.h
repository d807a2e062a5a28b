// SPDX-License-Identifier: GPL-3.0-or-later
// Radiance of a target through grey air. All calculations use radiance; only the result is converted to kelvin.
#pragma once

#include <optional>

#include "acquisition/base/result.h"
#include "sim_devices/atmosphere/band_radiance.h"

namespace todbench {

/// Target and background with the same emissivity. The reflectance of both surfaces is 1 - emissivity.
struct RadiativeScene {
  double target_k = 302,    ///< temperature of the target surface
      background_k = 300;   ///< temperature of the background surface
  double emissivity = 1;    ///< emissivity of both surfaces, above 0 and at most 1
  double surround_k = 300;  ///< radiation temperature of the surround that both surfaces reflect
  double air_k = 300;       ///< temperature of the air along the path
};
/// Checks a scene. Error: `invalid_input` (a temperature of 0 K or below, an emissivity outside 0 to 1).
[[nodiscard]] Result<void> validate(const RadiativeScene& scene);

/// Returns the radiance difference between target and background at the target in W/(m2 sr), e [B(target) -
/// B(background)], with the emissivity e and B: band_radiance(). At the camera the difference is multiplied by the
/// transmittance of the air. Path radiance and reflections are equal for target and background and cancel.
[[nodiscard]] double radiance_contrast(const SpectralBand& band, const RadiativeScene& scene);
/// Converts a radiance contrast to kelvin: divides the contrast by dB/dT at `calibration_k`, the temperature for which
/// the NETD of the camera is stated (B: band_radiance()). The conversion is linear, so air multiplies the result by its
/// transmittance.
[[nodiscard]] double equivalent_contrast_k(const SpectralBand& band, double radiance_contrast_w_m2_sr,
                                           double calibration_k);

/// Temperatures that a camera with a linear temperature scale displays: those of black bodies with the radiance L = tau
/// [e B(T) + (1 - e) B(surround)] + (1 - tau) B(air). tau: transmittance, e: emissivity, B: band_radiance().
struct ApparentTemperatures {
  double target_k = 0,   ///< apparent temperature of the target
      background_k = 0;  ///< apparent temperature of the background
  /// Returns the apparent contrast in kelvin.
  [[nodiscard]] double contrast_k() const { return target_k - background_k; }
};
/// Returns the apparent temperatures; empty if no temperature below 1e6 K has the radiance. Precondition: a valid
/// scene, 0 <= transmittance <= 1.
[[nodiscard]] std::optional<ApparentTemperatures> apparent_temperatures(const SpectralBand& band,
                                                                        const RadiativeScene& scene,
                                                                        double transmittance);
/// Returns the path radiance (1 - transmittance) B(air), in W/(m2 sr), which air adds to target and background.
[[nodiscard]] double path_radiance(const SpectralBand& band, double air_k, double transmittance);

}  // namespace todbench
