// SPDX-License-Identifier: GPL-3.0-or-later
// Turbulence of the air on a horizontal path of constant Cn2.
#pragma once

namespace todbench {

/// Turbulent path.
struct TurbulentPath {
  double cn2_m_minus_2_3 = 1e-14;  ///< structure parameter, > 0
  double path_m = 1000;            ///< > 0
  double wavelength_um = 10;       ///< > 0
};

/// Returns Fried's coherence diameter for a plane wave: (0.423 k^2 Cn2 L)^(-3/5), in metres.
[[nodiscard]] double fried_plane_m(const TurbulentPath& path);
/// Returns the coherence diameter in metres for a spherical wave from the target, with the weight (z / L)^(5/3), z from
/// the target. The result is (8/3)^(3/5) = 1.80 times the diameter for the plane wave.
[[nodiscard]] double fried_spherical_m(const TurbulentPath& path);

/// Returns 3.44 (lambda nu / r0)^(5/3), the exponent of long_exposure_mtf(), with the spherical r0 (Fried 1966).
[[nodiscard]] double long_exposure_exponent(const TurbulentPath& path, double cycles_per_mrad);
/// Returns the transfer function of the long exposure, exp[-3.44 (lambda nu / r0)^(5/3)], with the spherical r0 (Fried
/// 1966).
[[nodiscard]] double long_exposure_mtf(const TurbulentPath& path, double cycles_per_mrad);
/// Returns the standard deviation of the image dance per axis in mrad: sqrt(0.182 (D / r0)^(5/3)) lambda / D (Noll
/// 1976).
[[nodiscard]] double tilt_sd_mrad(const TurbulentPath& path, double aperture_m);

}  // namespace todbench
