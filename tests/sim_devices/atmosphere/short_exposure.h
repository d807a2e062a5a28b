// SPDX-License-Identifier: GPL-3.0-or-later
// Fried's short exposure (1966), against which the sensor's image dance is checked.
#pragma once

#include <cmath>
#include <optional>

#include "sim_devices/atmosphere/turbulence.h"

namespace todbench {

enum class PropagationField { near_field, far_field };
/// Short exposure: the exponent times 1 - a (lambda nu / D)^(1/3), a = 1 in the near field and 1/2 in the far field. It
/// can exceed the long exposure. Empty beyond the cut-off of the aperture, nu > D / lambda.
inline std::optional<double> short_exposure_mtf(const TurbulentPath& path, double aperture_m, PropagationField field,
                                                double cycles_per_mrad) {
  const double relative = 1e-6 * path.wavelength_um * cycles_per_mrad * 1000 / aperture_m;
  if (relative > 1) return std::nullopt;
  const double a = field == PropagationField::near_field ? 1 : 0.5;
  return std::exp(-long_exposure_exponent(path, cycles_per_mrad) * (1 - a * std::cbrt(relative)));
}

}  // namespace todbench
