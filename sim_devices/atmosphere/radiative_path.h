// What a camera sees of a target through grey air: radiance is carried, and made kelvin once.
#pragma once

#include <optional>

#include "acquisition/core/result.h"
#include "sim_devices/atmosphere/band_radiance.h"

namespace todbench {

/// Target and background of one emissivity; what they do not emit they reflect of the surround.
struct RadiativeScene {
  double target_k = 302, background_k = 300;
  double emissivity = 1;    ///< above 0, at most 1
  double surround_k = 300;  ///< radiation temperature of what is reflected
  double air_k = 300;       ///< of the path
};
/// `invalid_input` in one sentence: a temperature of 0 K or below, an emissivity outside 0 to 1.
[[nodiscard]] Result<void> validate(const RadiativeScene& scene);

/// Difference of radiance before the air, e [B(target) - B(background)] in W/(m2 sr); behind it, times tau. Path
/// radiance and equal reflections drop out.
[[nodiscard]] double radiance_contrast(const SpectralBand& band, const RadiativeScene& scene);
/// A radiance contrast in kelvin at the temperature at which the camera's NETD was stated: divided by dB/dT there. The
/// one conversion of the chain; what air leaves of it is the same factor tau.
[[nodiscard]] double equivalent_contrast_k(const SpectralBand& band, double radiance_contrast_w_m2_sr,
                                           double calibration_k);

/// What a camera that is linear in temperature shows: the radiation temperatures of
/// L = tau [e B(T) + (1 - e) B(surround)] + (1 - tau) B(air).
struct ApparentTemperatures {
  double target_k = 0, background_k = 0;
  [[nodiscard]] double contrast_k() const { return target_k - background_k; }
};
/// Precondition: a valid scene, 0 <= transmittance <= 1. Nothing where a radiance has no temperature below 1e6 K.
[[nodiscard]] std::optional<ApparentTemperatures> apparent_temperatures(const SpectralBand& band,
                                                                        const RadiativeScene& scene,
                                                                        double transmittance);
/// (1 - tau) B(air) in W/(m2 sr): what the path adds to target and background alike.
[[nodiscard]] double path_radiance(const SpectralBand& band, double air_k, double transmittance);

}  // namespace todbench
