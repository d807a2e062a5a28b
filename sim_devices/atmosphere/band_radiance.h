// Radiance of a black body in a band of wavelengths, and back to a temperature.
#pragma once

#include <optional>

#include "acquisition/core/result.h"

namespace todbench {

/// Wavelengths between which a camera sees, 0 < low < high.
struct SpectralBand {
  double low_um = 7.5, high_um = 13;
  bool operator==(const SpectralBand&) const = default;
};
/// `invalid_input` with one sentence.
[[nodiscard]] Result<void> validate(const SpectralBand& band);

/// Planck's law integrated over the band, in W/(m2 sr), by the series of the integral; to 1e-14 below 2000 K.
/// Precondition: a temperature above 0 K.
[[nodiscard]] double band_radiance(const SpectralBand& band, double temperature_k);
/// Its derivative by temperature, in W/(m2 sr K).
[[nodiscard]] double band_radiance_derivative(const SpectralBand& band, double temperature_k);
/// The temperature of the black body with this radiance; nothing for one of 0 or less, or beyond 1e6 K.
[[nodiscard]] std::optional<double> radiation_temperature_k(const SpectralBand& band, double radiance_w_m2_sr);
/// Weight dL/dT of a wavelength, in power, up to a factor.
[[nodiscard]] double thermal_weight(double wavelength_um, double temperature_k);

}  // namespace todbench
