// SPDX-License-Identifier: GPL-3.0-or-later
// Contrast threshold of the human eye.
#pragma once

namespace todbench {

/// Viewing conditions. The default values describe a display of 10 foot-lamberts.
struct EyeConditions {
  double luminance_cd_m2 = 34.26;
  double field_degrees = 15;  ///< side of the field
  int eyes = 2;
};

/// Returns the contrast threshold according to Barten: sqrt(2 / eyes) / (a u e^(-b u) sqrt(1 + 0.06 e^(b u))) with a =
/// 540 (1 + 0.7 / L)^-0.2 / (1 + 12 / (w (1 + u / 3)^2)), b = 0.3 (1 + 100 / L)^0.15, u in cycles per degree > 0, L in
/// cd/m2, w in degrees. May be infinite.
[[nodiscard]] double eye_contrast_threshold(double cycles_per_degree, const EyeConditions& eye);

}  // namespace todbench
