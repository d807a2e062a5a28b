// SPDX-License-Identifier: GPL-3.0-or-later
// Turbulence of the air on a horizontal path of constant Cn2.
#pragma once

namespace todbench {

/// Turbulent path.
struct TurbulentPath {
  double cn2_m_minus_2_3 = 1e-14;  ///< structure parameter Cn2, > 0
  double path_m = 1000;            ///< length L of the path, > 0
  double wavelength_um = 10;       ///< wavelength lambda, > 0
};

/// Returns Fried's coherence diameter for a plane wave in metres: (0.423 k^2 Cn2 L)^(-3/5), k = 2 pi / lambda.
[[nodiscard]] double fried_plane_m(const TurbulentPath& path);
/// Returns the coherence diameter r0 in metres for a spherical wave from the target: turbulence at the distance z from
/// the target has the weight (z / L)^(5/3). The result is (8/3)^(3/5) = 1.80 times fried_plane_m().
[[nodiscard]] double fried_spherical_m(const TurbulentPath& path);

/// Returns 3.44 (lambda nu / r0)^(5/3) (Fried 1966). nu: `cycles_per_mrad`; r0: fried_spherical_m().
[[nodiscard]] double long_exposure_exponent(const TurbulentPath& path, double cycles_per_mrad);
/// Returns the transfer function of the long exposure, exp(-long_exposure_exponent()) (Fried 1966), which is the mean
/// over many short exposures.
[[nodiscard]] double long_exposure_mtf(const TurbulentPath& path, double cycles_per_mrad);
/// Returns the standard deviation of the image dance per axis in mrad: sqrt(0.182 (D / r0)^(5/3)) lambda / D (Noll
/// 1976). D: `aperture_m`; r0: fried_spherical_m().
[[nodiscard]] double tilt_sd_mrad(const TurbulentPath& path, double aperture_m);

}  // namespace todbench
