// SPDX-License-Identifier: GPL-3.0-or-later
// Detection of compact patterns by the eye. At contrast 1, d'^2 is the integral of |H F|^2 over frequency: H is the
// eye's filter (EyeFilter), F the spectrum of the pattern in square degrees. A compact pattern is so small that the eye
// sums over its whole area. For a Gabor pattern, the area of summation is limited.
#pragma once

#include "hvs/eye/contrast_sensitivity.h"

namespace todbench {

/// Returns d' of a blob exp(-r^2 / (2 sigma^2)).
[[nodiscard]] double blob_d_prime(const EyeFilter& eye, double sigma_deg);
/// Returns d' of a uniform disc.
[[nodiscard]] double disc_d_prime(const EyeFilter& eye, double radius_deg);

/// Profile across a line.
enum class LineProfile {
  line,    ///< one bright stripe
  dipole,  ///< a bright stripe beside a dark stripe
};
/// Returns d' of stripes in a Gaussian window exp(-r^2 / (2 sigma^2)) that is much wider than a stripe.
[[nodiscard]] double line_d_prime(const EyeFilter& eye, double width_deg, double window_sigma_deg, LineProfile profile);

}  // namespace todbench
