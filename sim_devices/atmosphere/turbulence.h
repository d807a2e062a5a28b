// SPDX-License-Identifier: GPL-3.0-or-later
// Turbulence of the air on a horizontal path of constant Cn2.
#pragma once

namespace todbench {

struct TurbulentPath {
  double cn2_m_minus_2_3 = 1e-14;  ///< structure parameter, > 0
  double path_m = 1000;            ///< > 0
  double wavelength_um = 10;       ///< > 0
};

/// Fried's coherence diameter for a plane wave: (0.423 k^2 Cn2 L)^(-3/5), in metres.
[[nodiscard]] double fried_plane_m(const TurbulentPath& path);
/// Coherence diameter in metres for a spherical wave from the target, weight (z / L)^(5/3) with z from the target:
/// (8/3)^(3/5) = 1.80 times that of the plane wave.
[[nodiscard]] double fried_spherical_m(const TurbulentPath& path);

/// 3.44 (lambda nu / r0)^(5/3), r0 spherical (Fried 1966).
[[nodiscard]] double long_exposure_exponent(const TurbulentPath& path, double cycles_per_mrad);
/// Long exposure: exp[-3.44 (lambda nu / r0)^(5/3)], r0 spherical (Fried 1966).
[[nodiscard]] double long_exposure_mtf(const TurbulentPath& path, double cycles_per_mrad);
/// Standard deviation of the image dance per axis in mrad: sqrt(0.182 (D / r0)^(5/3)) lambda / D (Noll 1976).
[[nodiscard]] double tilt_sd_mrad(const TurbulentPath& path, double aperture_m);

}  // namespace todbench
