// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/atmosphere/turbulence.h"

#include <cmath>
#include <numbers>

namespace todbench {
namespace {

double wavelength_m(const TurbulentPath& path) {
  return path.wavelength_um * 1e-6;
}

}  // namespace

double fried_plane_m(const TurbulentPath& path) {
  const double k = 2 * std::numbers::pi / wavelength_m(path);
  return std::pow(0.423 * k * k * path.cn2_m_minus_2_3 * path.path_m, -0.6);
}

double fried_spherical_m(const TurbulentPath& path) {
  return std::pow(8.0 / 3, 0.6) * fried_plane_m(path);
}

double long_exposure_exponent(const TurbulentPath& path, double cycles_per_mrad) {
  return 3.44 * std::pow(wavelength_m(path) * cycles_per_mrad * 1000 / fried_spherical_m(path), 5.0 / 3);
}

double long_exposure_mtf(const TurbulentPath& path, double cycles_per_mrad) {
  return std::exp(-long_exposure_exponent(path, cycles_per_mrad));
}

double tilt_sd_mrad(const TurbulentPath& path, double aperture_m) {
  return 1000 * std::sqrt(0.182 * std::pow(aperture_m / fried_spherical_m(path), 5.0 / 3)) * wavelength_m(path) /
         aperture_m;
}

}  // namespace todbench
