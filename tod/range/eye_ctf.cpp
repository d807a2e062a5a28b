// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/range/eye_ctf.h"

#include <cmath>

namespace todbench {

double eye_contrast_threshold(double u, const EyeConditions& eye) {
  const double field = eye.field_degrees * (1 + u / 3) * (1 + u / 3);
  const double a = 540 * std::pow(1 + 0.7 / eye.luminance_cd_m2, -0.2) / (1 + 12 / field);
  const double b = 0.3 * std::pow(1 + 100 / eye.luminance_cd_m2, 0.15);
  return std::sqrt(2.0 / eye.eyes) / (a * u * std::exp(-b * u) * std::sqrt(1 + 0.06 * std::exp(b * u)));
}

}  // namespace todbench
