// SPDX-License-Identifier: GPL-3.0-or-later
// Radiance of a black body in a band of wavelengths, and its inverse.
#pragma once

#include <optional>

#include "acquisition/base/result.h"

namespace todbench {

/// Limits of the wavelengths that a camera detects, 0 < low < high.
struct SpectralBand {
  double low_um = 7.5, high_um = 13;
  bool operator==(const SpectralBand&) const = default;
};
/// Checks the limits. Errors: `invalid_input`.
[[nodiscard]] Result<void> validate(const SpectralBand& band);

/// Returns Planck's law integrated over the band, in W/(m2 sr), from the series of the integral; accurate to 1e-14
/// below 2000 K. Precondition: temperature above 0 K.
[[nodiscard]] double band_radiance(const SpectralBand& band, double temperature_k);
/// Returns the derivative of band_radiance() by temperature, in W/(m2 sr K).
[[nodiscard]] double band_radiance_derivative(const SpectralBand& band, double temperature_k);
/// Returns the temperature of the black body with this radiance; empty for a radiance of 0 or less, or above the
/// radiance at 1e6 K.
[[nodiscard]] std::optional<double> radiation_temperature_k(const SpectralBand& band, double radiance_w_m2_sr);
/// Returns the derivative of the spectral radiance (power units) by temperature, in an arbitrary constant unit.
[[nodiscard]] double thermal_weight(double wavelength_um, double temperature_k);

}  // namespace todbench
