#include "acquisition/core/accuracy.h"

namespace todbench {

Accuracy Accuracy::draft() {
  return {.acuity_tolerance_percent = 5,
          .wrap_tolerance = 1.7e-4,
          .band_tolerance = 1e-3,
          .wavelengths = 1,
          .phases_per_axis = 4,
          .noise_draws = 100};
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
          .noise_draws = 4000};
}

Result<Accuracy> Accuracy::named(std::string_view level) {
  if (level == "draft") return draft();
  if (level == "normal") return normal();
  if (level == "reference") return reference();
  return fail(ErrorCode::invalid_input, "accuracy '" + std::string(level) + "' is not one of draft, normal, reference");
}

}  // namespace todbench
