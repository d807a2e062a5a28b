// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/base/accuracy.h"

#include <algorithm>

namespace todbench {

Accuracy Accuracy::for_tolerance(double acuity_tolerance_percent) {
  const double t = acuity_tolerance_percent;
  // Pixel errors affect acuity only near a tenth of the internal noise (0.007 of the contrast); at 1 % these tolerances
  // stay a hundred times below that. Four wavelengths give pixels to 2e-6, one to 2e-3. 4 x 4 phases instead of 8 x 8
  // change the acuity by less than 1 %.
  return {.acuity_tolerance_percent = t,
          .wrap_tolerance = std::clamp(1.5e-5 * t, 1.7e-6, 1.7e-4),
          .band_tolerance = std::clamp(1e-4 * t, 1e-6, 1e-3),
          .wavelengths = t >= 5 ? 1 : (t >= 0.5 ? 4 : 16),
          .phases_per_axis = t >= 4 ? 4 : 8,
          // Initial number: the standard error is near 5.7 % / sqrt(draws) at high contrasts and twice that at low
          // ones.
          .noise_draws = static_cast<int>(std::clamp(100 / (t * t), 40.0, 600.0)),
          .standard_error_percent = t / 2};
}

Accuracy Accuracy::draft() {
  return {.acuity_tolerance_percent = 5,
          .wrap_tolerance = 1.7e-4,
          .band_tolerance = 1e-3,
          .wavelengths = 1,
          .phases_per_axis = 4,
          .noise_draws = 100,
          .standard_error_percent = 0};
}

Accuracy Accuracy::normal() {
  return {};
}

Accuracy Accuracy::reference() {
  return {.acuity_tolerance_percent = 0.2,
          .wrap_tolerance = 1.7e-6,
          .band_tolerance = 1e-6,
          .wavelengths = 16,
          .phases_per_axis = 8,
          .noise_draws = 4000,
          .standard_error_percent = 0};
}

Result<Accuracy> Accuracy::named(std::string_view level) {
  if (level == "auto") return for_tolerance(Accuracy{}.acuity_tolerance_percent);
  if (level == "draft") return draft();
  if (level == "normal") return normal();
  if (level == "reference") return reference();
  return fail(ErrorCode::invalid_input,
              "accuracy '" + std::string(level) + "' is not one of auto, draft, normal, reference");
}

}  // namespace todbench
