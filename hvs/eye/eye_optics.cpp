// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/eye/eye_optics.h"

#include <cmath>
#include <numbers>

namespace todbench {

double pupil_diameter_mm(double luminance_cd_m2, double field_deg2, double age_years) {
  constexpr double reference_age_years = 28.58;
  const double flux = std::pow(luminance_cd_m2 * field_deg2 / 846, 0.41);
  const double standard_mm = 7.75 - 5.75 * flux / (flux + 2);  // Stanley and Davies 1995
  return standard_mm + (age_years - reference_age_years) * (0.02132 - 0.009562 * standard_mm);
}

double retinal_illuminance_td(double luminance_cd_m2, double pupil_mm) {
  const double stiles_crawford = 1 - std::pow(pupil_mm / 9.7, 2) + std::pow(pupil_mm / 12.4, 4);
  return std::numbers::pi / 4 * pupil_mm * pupil_mm * luminance_cd_m2 * stiles_crawford;
}

double diffraction_limit_per_degree(double pupil_mm) {
  constexpr double wavelength_nm = 555;
  return std::numbers::pi * pupil_mm * 1e6 / (180 * wavelength_nm);
}

double eye_mtf(double frequency_per_degree, double pupil_mm) {
  const double x = frequency_per_degree / diffraction_limit_per_degree(pupil_mm);
  if (x >= 1) return 0;
  const double diffraction = 2 / std::numbers::pi * (std::acos(x) - x * std::sqrt(1 - x * x));
  const double corner = 21.95 - 5.512 * pupil_mm + 0.3922 * pupil_mm * pupil_mm;
  return std::sqrt(diffraction) * std::pow(1 + std::pow(frequency_per_degree / corner, 2), -0.62);
}

}  // namespace todbench
