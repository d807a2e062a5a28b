// SPDX-License-Identifier: GPL-3.0-or-later
// Diffraction at the aperture, over the wavelengths of the band.
#pragma once

#include <vector>

#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Returns the transfer function of a circular aperture at one wavelength, (2/pi)(acos X - X sqrt(1 - X^2)) with X =
/// `rho_per_pitch` x wavelength x f-number / pitch; 0 for X >= 1 (Goodman, Fourier Optics, 3rd ed., 6-31).
[[nodiscard]] double diffraction_mtf(double rho_per_pitch, double wavelength_um, double f_number, double pitch_um);

/// A wavelength with its weight; weights sum to 1.
struct WavelengthNode {
  double wavelength_um = 0, weight = 0;
};
/// Returns the Gauss-Legendre nodes over the band, weighted with dL/dT of a black body at scene_temperature_k (Planck,
/// power units). `count` is 1 to 64; for 1 the node is the weighted mean wavelength.
[[nodiscard]] std::vector<WavelengthNode> wavelength_nodes(const SensorSpec& spec, int count);

}  // namespace todbench
