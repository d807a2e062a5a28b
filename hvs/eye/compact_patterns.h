// SPDX-License-Identifier: GPL-3.0-or-later
// Detection of compact patterns by the eye: d'^2 at contrast 1 is the integral of |H F|^2, with the spectrum F of the
// pattern in square degrees. Over such a small area summation is not limited, unlike for a Gabor pattern.
#pragma once

#include "hvs/eye/contrast_sensitivity.h"

namespace todbench {

/// A blob exp(-r^2 / (2 sigma^2)).
[[nodiscard]] double blob_d_prime(const EyeFilter& eye, double sigma_deg);
/// A uniform disc.
[[nodiscard]] double disc_d_prime(const EyeFilter& eye, double radius_deg);

/// Profile across a line.
enum class LineProfile {
  line,    ///< one bright stripe
  dipole,  ///< a bright stripe beside a dark one
};
/// Stripes of a width in a Gaussian window exp(-r^2 / (2 sigma^2)) that is wide against them.
[[nodiscard]] double line_d_prime(const EyeFilter& eye, double width_deg, double window_sigma_deg, LineProfile profile);

}  // namespace todbench
