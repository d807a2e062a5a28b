// SPDX-License-Identifier: GPL-3.0-or-later
// Radiance of a target through grey air. All calculations use radiance, which is converted to kelvin once.
#pragma once

#include <optional>

#include "acquisition/base/result.h"
#include "sim_devices/atmosphere/band_radiance.h"

namespace todbench {

/// Target and background with the same emissivity. They reflect the surround with 1 - emissivity.
struct RadiativeScene {
  double target_k = 302, background_k = 300;
  double emissivity = 1;    ///< above 0, at most 1
  double surround_k = 300;  ///< radiation temperature of the reflected surround
  double air_k = 300;       ///< temperature of the air along the path
};
/// Checks a scene. Errors: `invalid_input` in one sentence (a temperature of 0 K or below, an emissivity outside 0 to
/// 1).
[[nodiscard]] Result<void> validate(const RadiativeScene& scene);

/// Returns the radiance difference in front of the air, e [B(target) - B(background)], in W/(m2 sr). Behind the air
/// this difference is multiplied by tau. Path radiance and equal reflections cancel.
[[nodiscard]] double radiance_contrast(const SpectralBand& band, const RadiativeScene& scene);
/// Converts a radiance contrast to kelvin: divides it by dB/dT at `calibration_k`, the temperature for which the NETD
/// of the camera is stated. The conversion is linear, so air also reduces the result by the factor tau.
[[nodiscard]] double equivalent_contrast_k(const SpectralBand& band, double radiance_contrast_w_m2_sr,
                                           double calibration_k);

/// Temperatures that a camera linear in temperature shows: the radiation temperatures of L = tau [e B(T) + (1 - e)
/// B(surround)] + (1 - tau) B(air).
struct ApparentTemperatures {
  double target_k = 0, background_k = 0;
  [[nodiscard]] double contrast_k() const { return target_k - background_k; }
};
/// Returns the apparent temperatures; empty if a radiance has no temperature below 1e6 K. Precondition: a valid scene,
/// 0 <= transmittance <= 1.
[[nodiscard]] std::optional<ApparentTemperatures> apparent_temperatures(const SpectralBand& band,
                                                                        const RadiativeScene& scene,
                                                                        double transmittance);
/// Returns the path radiance (1 - tau) B(air) in W/(m2 sr), which is added to target and background.
[[nodiscard]] double path_radiance(const SpectralBand& band, double air_k, double transmittance);

}  // namespace todbench
