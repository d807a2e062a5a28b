#include "bench/run/simulated_responses.h"

#include <cmath>

#include "sim_devices/prediction/contrast_response.h"
#include "sim_devices/prediction/module_response.h"

namespace todbench {
namespace {

double largest_contrast(const Plan& plan) {
  double largest = 0;
  for (const double contrast : plan.target.delta_t_k) {
    if (std::abs(contrast) > std::abs(largest)) largest = contrast;
  }
  return largest;
}

}  // namespace

Result<std::map<std::string, double>> simulated_responses(const SensorModel& model, const Plan& plan,
                                                          const std::vector<TargetPlate>& plates,
                                                          const MeasurementOptions& options, std::stop_token stop) {
  std::map<std::string, double> out;
  RegistrationOptions registration = options.registration;
  registration.expected_scale_px_per_mm =
      1 / (plan.target.distance_m * model.spec().ifov_mrad() / model.spec().samples_per_pitch());
  for (const auto& plate : plates) {
    if (sensor_module(model.spec()) != nullptr) {
      auto response = module_response(model.spec(), model.seed(), plate,
                                      {.delta_t_k = largest_contrast(plan),
                                       .distance_m = plan.target.distance_m,
                                       .min_reference_px = options.min_reference_px,
                                       .registration = registration,
                                       .level = level_estimate(options.contrast_unit)},
                                      stop);
      if (!response) return tl::unexpected(response.error());
      out[plate.name] = *response;
      continue;
    }
    auto response = contrast_response(model, plate, plan.target.distance_m, options.min_reference_px, registration,
                                      stop, level_estimate(options.contrast_unit));
    if (!response) return tl::unexpected(response.error());
    out[plate.name] = *response;
  }
  return out;
}

}  // namespace todbench
